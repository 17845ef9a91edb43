"""The world around the kernel: simulated CAN, drive nodes, rigs, plan runner, command line."""

import os

# Arrow takes its memory where everything else does. The allocator that it brings along reserves
# 1 GB in pages of 2 MB, so that what a run needs counts in steps of 2 MB; it is chosen at import
os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
