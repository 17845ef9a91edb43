"""The equations of a model, sorted, solved and told apart by when they act."""
