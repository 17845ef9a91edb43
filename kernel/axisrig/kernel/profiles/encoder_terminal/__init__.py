"""Words of an incremental encoder terminal, as both ends take them."""
