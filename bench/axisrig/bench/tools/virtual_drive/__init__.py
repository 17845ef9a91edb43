"""Drives of a rig for a master outside."""
