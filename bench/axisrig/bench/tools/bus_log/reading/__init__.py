"""Files of frames of this bench and of other tools, read as messages in the order of time."""
