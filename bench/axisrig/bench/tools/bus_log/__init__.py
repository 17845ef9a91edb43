"""A stored bus log in words."""
