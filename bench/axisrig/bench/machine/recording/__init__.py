"""Observers of a running machine: what they keep becomes its recording."""
