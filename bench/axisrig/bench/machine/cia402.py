"""What drives of CiA 402 in a machine have in common, whatever carries them."""

from collections.abc import Mapping, Sequence
from typing import Final

from axisrig.bench.machine.families import Bench, Installed
from axisrig.bench.record.axes import DriveState
from axisrig.kernel.drives.canopen.drive_functions import DriveAccess, DriveFunctions
from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.functions import read_functions
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, TimeNs

LOAD_SPAN_NS: Final[TimeNs] = 100 * MS
"""The load that is shown is that of so much time."""
_OFF: Final = (State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.FAULT)
_TROUBLE: Final = (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE, State.FAULT)


class Cia402Segments(Installed):
    """Segments with drives of CiA 402, and others beside them; a carrier derives its own from it.

    It fills `states` and `links`, and calls `_open_ways` when the links are made.
    """

    states: Mapping[str, list[DriveState]]

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._bench = bench
        self._accesses: dict[str, DriveAccess] = {}
        self._warnings: list[Alarm] = []

    def _note_state(self, axis: str, state: State) -> None:
        now_ns = self._bench.scheduler.now_ns
        self.states[axis].append(DriveState(now_ns, state.name, state in _TROUBLE))

    def _open_ways(self) -> None:
        """Make the ways of #DRIVE to every drive; limits that are corrected give a warning."""
        for axis, link in self.links.items():
            if not isinstance(link, Cia402Drive):
                continue
            functions, found = read_functions(axis, self._bench.settings.axis[axis])
            self._warnings += found
            assert link.sdo is not None, "made with it"
            self._accesses[axis] = DriveAccess(link, link.sdo, functions)

    def functions(self) -> DriveAccesses | None:
        """Return what #DRIVE acts on."""
        return DriveFunctions(self._accesses) if self._accesses else None

    @property
    def accesses(self) -> Mapping[str, DriveAccess]:
        """The ways to objects of drives, by axis."""
        return self._accesses

    @property
    def warnings(self) -> Sequence[Alarm]:
        """Limits of drive functions that were corrected."""
        return self._warnings

    def is_off(self, axis: str) -> bool:
        """Whether the drive of an axis has left operation."""
        link = self.links[axis]
        if isinstance(link, Cia402Drive):
            return link.state in _OFF
        return link.power in (Power.OFF, Power.FAULT)
