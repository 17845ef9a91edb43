"""Closed forms of a measurement run with a probe."""
