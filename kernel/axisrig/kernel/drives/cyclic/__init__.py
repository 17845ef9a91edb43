"""The control's end of a segment that swaps one image in and out in each cycle."""
