"""What somebody with a real control looks at to decide how distance control works there."""
