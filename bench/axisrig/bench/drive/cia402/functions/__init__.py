"""Functions of the drive application: limits, ramps, latch, inputs, stops, sampling."""
