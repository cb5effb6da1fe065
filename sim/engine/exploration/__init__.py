"""Exploring the orders of a program's threads: where its own lines share data, and who may go on there."""
