"""Words of PROFIdrive drives and their tables, as both ends take them."""
