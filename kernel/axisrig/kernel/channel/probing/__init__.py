"""Latches of measuring axes whose signal or hardware is at the PLC (P-AXIS-00516)."""
