"""The control's end of PROFIdrive drives."""
