"""The options that commands share, and the words and streams they refuse."""
