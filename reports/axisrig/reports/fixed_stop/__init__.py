"""Section of the report on runs to a fixed stop: timeline, signals, answers in words."""
