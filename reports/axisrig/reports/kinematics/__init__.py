"""Section of the report about the tool of a kinematic: side view, signals, diagnosis data."""
