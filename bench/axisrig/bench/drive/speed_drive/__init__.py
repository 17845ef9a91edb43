"""The virtual drive that only takes a speed."""
