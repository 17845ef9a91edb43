"""What a rig says of CANopen drives: their keys, their telegrams, whether a cycle fits on CAN."""
