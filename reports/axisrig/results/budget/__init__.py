"""The page and the table of `axisrig budget`."""
