"""The PLC side of a running machine."""
