"""What any drive does with its axis: motion, ramps, inputs, latches, switches."""
