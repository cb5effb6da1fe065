"""The trace: typed events of a run, and the timeline that answers questions about them."""
