"""A rig: its file, its checks, what a run changes on it, and the machine that comes of it."""
