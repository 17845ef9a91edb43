"""Axes with a speed drive and an encoder terminal, as a rig has them."""
