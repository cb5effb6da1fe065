"""A plugin for pytest: runs nodes, launch files and lessons on virtual time, and asserts what they do."""
