"""Explores the orders of a program's threads: where lines share data, and which thread continues there."""
