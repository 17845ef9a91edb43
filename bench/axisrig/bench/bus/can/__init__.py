"""CAN: segments, controllers, the line, records, real interfaces."""
