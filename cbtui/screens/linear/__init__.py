"""The console for screen readers: it prints lines on what happens, and never repaints."""
