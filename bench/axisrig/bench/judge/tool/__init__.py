"""Runs with a kinematic: what its tool was, for the report."""
