"""The command line: every command of `axisrig`."""
