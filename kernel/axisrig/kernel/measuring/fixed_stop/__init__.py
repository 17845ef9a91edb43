"""Measuring type 7: an axis runs against a mechanical stop, and standing there is the signal."""
