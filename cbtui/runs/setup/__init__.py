"""What a run is set up with: a lesson or files, and what a person changed."""
