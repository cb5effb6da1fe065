"""Nodes, and the parts of every node: parameter services, clock, ``/rosout``."""
