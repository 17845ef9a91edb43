"""Faults of a run: where they act, and when."""
