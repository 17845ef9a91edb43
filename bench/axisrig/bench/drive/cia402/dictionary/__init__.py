"""Objects of the drive: dictionary, profile, EDS, process image, store, abort codes."""
