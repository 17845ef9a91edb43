"""CiA 402: states, commands, transitions, touch probe."""
