"""PROFIdrive drives as a rig has them: their keys and checks."""
