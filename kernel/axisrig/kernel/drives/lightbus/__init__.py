"""The control's end of drives on Lightbus."""
