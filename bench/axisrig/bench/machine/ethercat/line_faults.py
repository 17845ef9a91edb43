"""What faults do to an EtherCAT line: its cyclic frames, and its slaves. `Disturbed` of `lines`."""

from collections.abc import Callable, Mapping

from axisrig.bench.bus.ethercat.segment import EthercatSegment
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.machine.faults.lines import Passing
from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE
from axisrig.kernel.drives.ethercat.master import FIRST_INDEX
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import TimeNs


class LineFaults:
    """The faults of one line; slaves: by axis, in their order on it."""

    def __init__(self, segment: EthercatSegment, slaves: Mapping[str, EthercatDrive]) -> None:
        self._segment, self._slaves = segment, slaves

    def disturb(self, passing: Passing) -> None:
        """Let each cyclic frame pass there too."""
        self._segment.passes.append(lambda frame: passing(frame) if _is_cyclic(frame) else 0)

    def breaks(self, axis: str, falls: Callable[[], bool]) -> None:
        """Break each cyclic frame before the slave of an axis for which this returns true."""
        place = list(self._slaves).index(axis)
        self._segment.breaks.append(
            lambda frame, number: number == place and _is_cyclic(frame) and falls()
        )

    def fall(self, axis: str, state: AlState, code: str) -> None:
        """Let the slave of an axis fall to a state with an AL status code by its name."""
        self._slaves[axis].states.fall(state, code)

    def jump(self, axis: str, by_ns: TimeNs) -> None:
        """Let the clock of a slave show a later time at once."""
        self._slaves[axis].jump(by_ns)


def _is_cyclic(frame: bytearray) -> bool:
    return frame[INDEX_PLACE] >= FIRST_INDEX
