"""A rig in operation: everything that exists only during a run."""
