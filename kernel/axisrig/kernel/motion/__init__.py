"""Motion: velocity profile, effective dynamics, interpolator and set point buffer."""
