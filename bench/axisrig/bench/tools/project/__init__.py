"""A project to start from: `axisrig new`."""
