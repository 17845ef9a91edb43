"""CANopen drives in operation: segments, nodes, the kernel's ends, what is recorded of them."""
