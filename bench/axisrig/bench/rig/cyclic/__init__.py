"""Drives on cyclic segments as a rig asks for them."""
