"""The equations of a model, sorted, solved and sorted by the times at which they act."""
