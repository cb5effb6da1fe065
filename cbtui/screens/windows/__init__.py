"""The windows that a screen opens over itself."""
