"""Images that are swapped once per cycle, whatever is in them.

What an NC cycle computes goes out with the next exchange, and what the drives have sampled comes in
with it: so much is said of the bus, and nothing of its frames.
"""

from collections.abc import Callable, Mapping

from axisrig.kernel.drives.carrier import Carrier
from axisrig.kernel.errors import Alarm


class ImagePort:
    """The images of one drive. outputs: for the next exchange. inputs: of this cycle, or None."""

    def __init__(self) -> None:
        self.outputs: bytes | None = None
        self.inputs: bytes | None = None

    def begin_cycle(self) -> None:
        """Forget what came: a cycle counts with its own image only."""
        self.inputs = None

    def receive(self, inputs: bytes) -> None:
        """Take the image of an exchange; an empty one is none."""
        self.inputs = inputs or None


Begin = Callable[[Mapping[str, bytes | None]], None]
"""Begins the exchange of a cycle with the outputs of each drive."""


class CyclicCarrier(Carrier):
    """One segment; ports: of its drives. begin: of the segment."""

    def __init__(self, name: str, ports: Mapping[str, ImagePort], begin: Begin) -> None:
        self.name, self._ports, self._begin = name, ports, begin

    def begin_cycle(self) -> None:
        """Swap images: outputs that nobody gives again are not sent again."""
        outputs = {axis: port.outputs for axis, port in self._ports.items()}
        for port in self._ports.values():
            port.outputs = None
        self._begin(outputs)

    @property
    def holds_back(self) -> bool:
        """An exchange has its time in each cycle; the rig is checked for it."""
        return False

    def late(self) -> Alarm:
        """Return the alarm of a cycle that was held back; there is none."""
        return Alarm(900031, segment=self.name)

    def check(self) -> Alarm | None:
        """A segment as a whole reports nothing."""
        return None


class CyclicStart:
    """The start-up of a drive that only has its images."""

    def begin(self, ended: Callable[[Alarm | None], None]) -> None:
        """It has ended before it began."""
        ended(None)
