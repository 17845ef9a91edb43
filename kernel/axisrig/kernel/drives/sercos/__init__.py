"""The control's end of SERCOS drives."""
