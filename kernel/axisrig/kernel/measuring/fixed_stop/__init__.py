"""Measuring type 7: an axis runs against a mechanical stop, and standstill there is the signal."""
