"""The control's end of conventional drives."""
