"""The clocks that programs read and sleep by."""
