"""CANopen: identifiers, abort codes, emergency codes."""
