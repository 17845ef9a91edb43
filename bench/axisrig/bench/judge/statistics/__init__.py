"""Statistics over the runs of a case, and over the measurement runs of a program."""
