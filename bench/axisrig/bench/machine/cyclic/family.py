"""Drives on cyclic segments in a machine."""

import hashlib
import random
from collections.abc import Callable, Sequence
from functools import partial

from axisrig.bench.bus.cyclic.segment import CyclicSegment
from axisrig.bench.machine.cyclic.conventional_drive import ConventionalEnds
from axisrig.bench.machine.cyclic.encoder_terminal_axis import EncoderTerminalEnds
from axisrig.bench.machine.cyclic.ends import ImageEnds, Plugged
from axisrig.bench.machine.cyclic.lightbus_drive import LightbusEnds
from axisrig.bench.machine.cyclic.profidrive_drive import ProfidriveEnds
from axisrig.bench.machine.families import Bench, Installed
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.images import OnImages
from axisrig.bench.machine.faults.injection import ON_IMAGES
from axisrig.bench.record.axes import DriveState, Telegram
from axisrig.bench.rig.cyclic.members import axes_on, cyclic_axes, cyclic_segments, instants_of
from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.drives.accesses import AccessesByAxis
from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier
from axisrig.kernel.drives.interface import DriveAccesses, DriveStart, DriveWatch
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import TimeNs

DRIVE_SEED_STRIDE = 1_000_003
ENDS: dict[str, Callable[[Plugged], ImageEnds]] = {
    "profidrive": ProfidriveEnds,
    "encoder_terminal": EncoderTerminalEnds,
    "conventional": ConventionalEnds,
    "lightbus": LightbusEnds,
}
_TROUBLE = (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE, State.FAULT)


class CyclicSegments(Installed):
    """The cyclic segments of a machine; segments, ends: by name and by axis."""

    states: dict[str, list[DriveState]]

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._bench, settings = bench, bench.settings
        axes = cyclic_axes(settings)
        self.states = {axis: [] for axis in axes}
        self.ends = {axis: self._ends(axis) for axis in axes}
        self.drives = {axis: ends.drive for axis, ends in self.ends.items()}
        self.nodes = {axis: ends.drive_node for axis, ends in self.ends.items()}
        self.links = {axis: ends.link for axis, ends in self.ends.items()}
        self.segments = {name: self._segment(name) for name in cyclic_segments(settings)}
        self.carriers = {
            name: CyclicCarrier(
                name,
                {axis: self.ends[axis].port for axis in axes_on(settings, name)},
                segment.begin,
            )
            for name, segment in self.segments.items()
        }

    def _ends(self, axis: str) -> ImageEnds:
        rig = self._bench.settings.rig
        seed = self._bench.seed + DRIVE_SEED_STRIDE * list(rig.axis).index(axis)
        family = rig.drive[rig.axis[axis].drive].family_name
        return ENDS[family](Plugged(self._bench, axis, seed, partial(self._note_state, axis)))

    def _segment(self, name: str) -> CyclicSegment:
        settings = self._bench.settings
        return CyclicSegment(
            self._bench.scheduler,
            {axis: self.ends[axis].node for axis in axes_on(settings, name)},
            instants_of(settings, name),
            lambda axis, inputs: self.ends[axis].port.receive(inputs),
        )

    def _note_state(self, axis: str, state: State) -> None:
        now_ns = self._bench.scheduler.now_ns
        self.states[axis].append(DriveState(now_ns, state.name, state in _TROUBLE))

    def functions(self) -> DriveAccesses | None:
        """Return what #DRIVE acts on."""
        by_axis = {}
        for axis, ends in self.ends.items():
            segment = self.segments[self._bench.settings.rig.axis[axis].segment]
            accesses = ends.accesses(segment.ask)
            if accesses is not None:
                by_axis[axis] = accesses
        return AccessesByAxis(by_axis) if by_axis else None

    @property
    def warnings(self) -> Sequence[Alarm]:
        """Limits of drive functions that were corrected."""
        return [alarm for ends in self.ends.values() for alarm in ends.warnings]

    def watch(self, axis: str) -> DriveWatch:
        """Make the watch over one drive."""
        return self.ends[axis].watch()

    def start_up(self, axis: str) -> DriveStart:
        """Make the start-up of one drive."""
        segment = self.segments[self._bench.settings.rig.axis[axis].segment]
        return self.ends[axis].start_up(segment.ask)

    def sampled_ns(self, axis: str, sync_ns: TimeNs) -> TimeNs:
        """Return when the actual position of this cycle is sampled: T_I before its begin."""
        segment = self._bench.settings.rig.axis[axis].segment
        return sync_ns - instants_of(self._bench.settings, segment).input_ns

    def build_fault(self, fault: Fault, numbers: random.Random, record: Injected) -> Act | None:
        """Build in a fault of images, or of a drive there; None for others."""
        on = fault.segment or self._bench.settings.rig.axis[fault.axis].segment
        if on not in self.segments:
            return None
        images = OnImages(self._bench.scheduler, self.segments[on], self.nodes)
        return ON_IMAGES[fault.kind](images, fault, numbers, record)

    def is_off(self, axis: str) -> bool:
        """Whether the drive of an axis has left operation."""
        return self.links[axis].power in (Power.OFF, Power.FAULT)

    def hexdigest(self) -> str:
        """Return a hash of all images of all segments."""
        digests = "".join(segment.hexdigest() for segment in self.segments.values())
        return hashlib.sha256(digests.encode()).hexdigest()

    def telegrams(self, axis: str) -> list[Telegram]:
        """Return what the images of an axis carry."""
        return self.ends[axis].telegrams


install = CyclicSegments
"""Installs the cyclic segments of a rig."""
