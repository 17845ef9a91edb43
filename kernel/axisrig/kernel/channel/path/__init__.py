"""What moves along the path: settings, look-ahead, interpolation, exact stop, measurement runs."""
