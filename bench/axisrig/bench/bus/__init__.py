"""Simulated CAN: segments with arbitration and exact frame times, python-can and canopen on top."""
