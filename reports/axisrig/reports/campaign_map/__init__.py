"""The whole campaign at a glance: a cell for each run and metric."""
