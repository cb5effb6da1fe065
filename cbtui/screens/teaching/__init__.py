"""Parts of screens that teach: predictions, what was learned, an exercise's help and its checks."""
