"""Measurement runs: arming the latches, judging the signals, delivering measured values."""
