"""Words of a drive on Lightbus, as both ends take them."""
