"""Measured speed: runs, the bus, FMUs, the parser."""
