"""The kernel's end of a drive that speaks CANopen."""
