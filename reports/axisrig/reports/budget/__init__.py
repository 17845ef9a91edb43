"""The budget of a measured value in the card of its run: a waterfall and a table of causes."""
