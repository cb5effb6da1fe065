"""One run seen from the console: set up, live, recorded, judged, compared or without a screen."""
