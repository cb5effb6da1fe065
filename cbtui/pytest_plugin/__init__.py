"""A plugin for pytest: nodes, launch files and lessons run on virtual time, and are asked what they did."""
