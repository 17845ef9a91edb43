"""The error of one measured value, taken apart by its causes."""
