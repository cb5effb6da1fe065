"""Names of nodes, topics, services and parameters: rules, expansion, remapping."""
