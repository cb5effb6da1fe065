"""Reads and writes files with care: whole or not at all, limited in size, without code in them."""
