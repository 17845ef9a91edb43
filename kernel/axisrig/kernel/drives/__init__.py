"""Drives as the CNC sees them: the folder of a family is its end of the drives that speak it."""
