"""A segment that swaps one image in and out in each cycle."""
