"""Parameters and their values, where they come from, and a node's store of them."""
