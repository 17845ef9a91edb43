"""Judges what a run has left: truths, metrics, findings."""
