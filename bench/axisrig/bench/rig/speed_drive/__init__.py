"""Drives that only take a speed, as a rig has them: their keys and checks."""
