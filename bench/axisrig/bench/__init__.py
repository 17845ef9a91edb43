"""The world around the kernel: simulated CAN, drive nodes, rigs, plan runner, command line."""
