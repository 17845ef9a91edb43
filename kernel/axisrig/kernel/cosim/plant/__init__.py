"""Plants of a machine, made of FMUs: axes, probes, distance sensors, their events and grid."""
