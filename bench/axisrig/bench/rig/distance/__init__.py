"""Distance control of a rig: what its check says, and what a run notes of it."""
