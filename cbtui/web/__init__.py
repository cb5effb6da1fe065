"""The console in a browser, through textual-serve: each visitor has a console, and engines, of their own."""
