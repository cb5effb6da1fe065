"""The nodes of unit 5, under the names that the course gives them."""
