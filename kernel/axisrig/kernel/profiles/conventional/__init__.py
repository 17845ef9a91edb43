"""Words of a card in the control for a conventional drive, as both ends take them."""
