"""Words of a drive that only takes a speed, as both ends take them."""
