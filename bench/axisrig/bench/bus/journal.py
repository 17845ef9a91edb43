"""Frames as they ended, kept until a block of them is worth working on.

Hash and log files act on nothing, so they need not see a frame at its instant: a block of frames
costs them a third of what the same frames cost one by one.
"""

from collections.abc import Callable
from typing import Any, Final

from axisrig.kernel.time.clock import TimeNs

Entry = tuple[TimeNs, str, Any, bool]
"""End of the frame in ns (of the delimiter for an error frame), segment, frame, is_error.

What a frame is says the carrier of its segment.
"""

BlockReader = Callable[[list[Entry]], None]

BLOCK_FRAMES: Final = 2048
"""Half a second of one axis at 1 ms."""


class Journal:
    """The frames of one or more segments in the order of their ends, given to readers in blocks.

    block_frames: so many frames make a block; 1 = each frame at once, for runs in real time.
    entries: what no reader has seen yet. Segments append to it and call `drain` when it is full;
    it stays the same list.
    """

    def __init__(self, block_frames: int = BLOCK_FRAMES) -> None:
        self.block_frames = block_frames
        self.entries: list[Entry] = []
        self._readers: list[BlockReader] = []

    def add(self, reader: BlockReader) -> None:
        """Give every block from now on to `reader` too, after the readers added before."""
        self.drain()
        self._readers.append(reader)

    def drain(self) -> None:
        """Give the readers what is there, full block or not.

        An exception of a reader passes through; the readers after it miss the block.
        """
        if self.entries:
            block = self.entries.copy()
            self.entries.clear()
            for reader in self._readers:
                reader(block)
