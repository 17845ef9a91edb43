"""Which frames of a log are shown."""
