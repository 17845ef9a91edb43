"""The control's end of axes with a speed drive and an encoder terminal."""
