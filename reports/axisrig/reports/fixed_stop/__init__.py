"""Section of the report that tells of runs to a fixed stop: timeline, signals, answers in words."""
