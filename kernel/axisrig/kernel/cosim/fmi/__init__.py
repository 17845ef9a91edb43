"""FMUs of any origin: archive, FMI 2.0 and 3.0, roles of their variables, units, calls kept."""
