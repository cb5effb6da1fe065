"""The set-up of a run: a lesson or files, and a person's changes."""
