"""Runs followed to their end: checked, explored, bounded."""
