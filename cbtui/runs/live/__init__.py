"""A run on the screen, live or replayed: its timeline, playhead, findings, recording and exports."""
