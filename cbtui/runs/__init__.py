"""One run as the console sees it: set up, live, recorded, judged, compared or headless."""
