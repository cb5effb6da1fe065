"""Palettes, colour themes, contrast and glyphs of everything on the screen."""
