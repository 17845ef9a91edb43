"""The control's end of drives that only take a speed."""
