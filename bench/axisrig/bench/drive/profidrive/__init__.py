"""The virtual PROFIdrive drive."""
