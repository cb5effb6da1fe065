"""The commands and verbs of ``ros2``, a module each."""
