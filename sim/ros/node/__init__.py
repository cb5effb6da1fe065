"""Nodes, and what every node brings along: its parameters' services, its clock, its log lines' topic."""
