"""Measurement runs with a latch: the touch as the plant saw it, metrics, marks."""
