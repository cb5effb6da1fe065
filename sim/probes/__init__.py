"""What tells a trace of the model's doings; speaks of ids and small protocols only."""
