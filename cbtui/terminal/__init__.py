"""What knows the terminal and the insides of Textual: drivers, signals, streams, the console's end."""
