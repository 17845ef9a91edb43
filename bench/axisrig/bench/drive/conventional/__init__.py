"""The card of the control for a conventional drive."""
