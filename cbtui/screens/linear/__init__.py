"""The console for screen readers: plain lines of what happens, appended and never repainted."""
