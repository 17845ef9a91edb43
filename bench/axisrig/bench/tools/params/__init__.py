"""`axisrig params`: what parameters there are, what a rig has set, and where two differ."""
