"""Parameters, their values in YAML, and a node's store of parameters."""
