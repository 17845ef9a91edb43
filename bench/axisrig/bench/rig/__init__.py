"""A rig on paper: its files, its checks, what a run sets on it; nothing here runs."""
