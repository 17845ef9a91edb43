"""Metrics over the inputs that the runs of a case differ in."""
