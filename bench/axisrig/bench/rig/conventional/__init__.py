"""Conventional drives, as a rig has them."""
