"""What a run shows of itself while it lasts, and the pipe that hands it over."""
