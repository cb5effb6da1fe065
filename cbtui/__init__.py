"""The terminal console: screens, widgets and commands."""
