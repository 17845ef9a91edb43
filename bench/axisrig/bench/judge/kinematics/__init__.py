"""Where the tool was while a kinematic was on, and the metrics of it."""
