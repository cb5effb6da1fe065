"""Exploring: programs with seeded bugs, and how soon each strategy finds them."""
