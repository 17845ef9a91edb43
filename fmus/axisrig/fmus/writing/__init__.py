"""What an FMU is made of: C source, variables, units, model description."""
