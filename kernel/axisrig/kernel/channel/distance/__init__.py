"""Distance control of axes: sensor, place in the cycle, commands, the way of the offset."""
