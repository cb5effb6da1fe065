"""The commands of ``cbtui``, a file each: what their options are, and what they do."""
