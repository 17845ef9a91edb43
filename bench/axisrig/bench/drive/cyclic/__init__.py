"""Virtual drives whose words come as one image in each cycle."""
