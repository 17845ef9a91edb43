"""Drives on cyclic segments in a machine."""
