"""Results folders beside each other: `axisrig diff` and `axisrig trend`."""
