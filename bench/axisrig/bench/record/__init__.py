"""What a run leaves, as data: read by judge and report, made by the machine."""
