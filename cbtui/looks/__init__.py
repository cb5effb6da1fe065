"""Palettes, colour themes, contrast and glyphs: what everything on the screen is drawn with."""
