"""Both ends of one drive on a cyclic segment, whatever its family."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from axisrig.bench.bus.cyclic.segment import Answer, ImageNode
from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.machine.families import Bench
from axisrig.bench.record.axes import Telegram
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.interface import Drive, DriveAccesses, DriveStart, DriveWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State


class Plugged(NamedTuple):
    """What a drive is made of. seed: of everything random in it. entered: gets its states."""

    bench: Bench
    axis: str
    seed: int
    entered: Callable[[State], None]


Ask = Callable[[Answer, bytes, Callable[[bytes], None]], None]
"""Brings a request beside the cycle to who answers it, and its response back."""


class ImageEnds:
    """A virtual drive and the control's end of it; a family derives its own.

    warnings: what was corrected when the ends were made.

    node: what the segment swaps images with. drive: as a machine sees it. port, link: of the
    control. telegrams: what the images carry.
    """

    node: ImageNode
    drive: VirtualDrive
    port: ImagePort
    link: Drive
    telegrams: list[Telegram]
    warnings: Sequence[Alarm] = ()

    @property
    def drive_node(self) -> Cia402Node:
        """The node with its supply."""
        assert isinstance(self.node, Cia402Node), "each family has such a one"
        return self.node

    def watch(self) -> DriveWatch:
        """Make the watch over the drive."""
        raise NotImplementedError

    def accesses(self, ask: Ask) -> DriveAccesses | None:
        """Return what #DRIVE acts on, None where the drive has nothing. ask: of its segment."""
        return None

    def start_up(self, ask: Ask) -> DriveStart:
        """Make the start-up of the drive. ask: of its segment."""
        raise NotImplementedError
