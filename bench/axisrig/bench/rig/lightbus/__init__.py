"""Drives on Lightbus, as a rig has them."""
