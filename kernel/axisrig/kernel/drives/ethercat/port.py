"""What a master needs of its port."""

from typing import Protocol


class EthercatPort(Protocol):
    """The port of a segment; the frames that come back are handed to `Master.received`."""

    def send(self, frame: bytes) -> None:
        """Send a frame at the present instant; never waits."""
        ...
