"""The virtual drive on Lightbus: its latches."""
