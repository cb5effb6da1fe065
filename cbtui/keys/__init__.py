"""Actions, key map and configuration: everything a person can press."""
