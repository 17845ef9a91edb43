"""Drives on cyclic segments in a machine: PROFIdrive."""

from functools import partial

from axisrig.bench.bus.cyclic.segment import CyclicSegment
from axisrig.bench.drive.profidrive.node import ProfidriveDrive as VirtualProfidrive
from axisrig.bench.machine.families import Bench, Installed
from axisrig.bench.record.axes import DriveState, Telegram
from axisrig.bench.rig.cyclic.members import (
    axes_on,
    cyclic_axes,
    cyclic_segments,
    instants_of,
    phases_of,
)
from axisrig.bench.rig.loop import feed_forward
from axisrig.bench.rig.profidrive.loop import gain_of, loop_settings, wrong_mode
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.lists import acceleration_mm_s2, drive_input, jump_mm
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier, CyclicStart, ImagePort
from axisrig.kernel.drives.interface import DriveStart, DriveWatch
from axisrig.kernel.drives.power import Power
from axisrig.kernel.drives.profidrive.link import ProfidriveDrive
from axisrig.kernel.drives.profidrive.settings import ProfidriveSettings
from axisrig.kernel.drives.profidrive.watch import ProfidriveWatch
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.profiles.profidrive.words import SPEED_BASE
from axisrig.kernel.time.clock import US, S

DRIVE_SEED_STRIDE = 1_000_003
_TROUBLE = (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE, State.FAULT)
BASE = "antr.profibus.drive_velocity_base_value"


class CyclicSegments(Installed):
    """The cyclic segments of a machine; segments, nodes: by name and by axis."""

    states: dict[str, list[DriveState]]

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._bench, settings = bench, bench.settings
        axes = cyclic_axes(settings)
        self.states = {axis: [] for axis in axes}
        self.nodes = {axis: self._node(axis) for axis in axes}
        self.drives = {axis: node.servo for axis, node in self.nodes.items()}
        self._links = {
            axis: ProfidriveDrive(profidrive_settings(settings, axis), ImagePort()) for axis in axes
        }
        self.links = self._links
        self.segments = {name: self._segment(name) for name in cyclic_segments(settings)}
        self.carriers = {
            name: CyclicCarrier(
                name,
                {axis: self._links[axis].port for axis in axes_on(settings, name)},
                segment.begin,
            )
            for name, segment in self.segments.items()
        }

    def _node(self, axis: str) -> VirtualProfidrive:
        bench, settings = self._bench, self._bench.settings
        beside = bench.beside
        seen = beside.axis(axis)
        if ControlKind.VELOCITY not in seen.kinds:
            raise rig_error(
                settings.files,
                ("axis", axis, "plant"),
                f"axis {axis}: its drive gives speeds, and its plant takes none",
                value=settings.rig.axis[axis].plant,
                hint="a plant whose FMU takes a speed, such as AxisRig.Drives.ServoAxis",
            )
        return VirtualProfidrive(
            axis,
            bench.scheduler,
            seen,
            beside.probes(axis),
            drive_of(settings, axis).make(),
            bench.seed + DRIVE_SEED_STRIDE * list(settings.rig.axis).index(axis),
            switches=beside.switches(axis),
            entered=partial(self._note_state, axis),
        )

    def _segment(self, name: str) -> CyclicSegment:
        settings = self._bench.settings
        return CyclicSegment(
            self._bench.scheduler,
            {axis: self.nodes[axis] for axis in axes_on(settings, name)},
            instants_of(settings, name),
            lambda axis, inputs: self._links[axis].port.receive(inputs),
        )

    def _note_state(self, axis: str, state: State) -> None:
        now_ns = self._bench.scheduler.now_ns
        self.states[axis].append(DriveState(now_ns, state.name, state in _TROUBLE))

    def watch(self, axis: str) -> DriveWatch:
        """Make the watch over one drive."""
        return ProfidriveWatch(self._links[axis])

    def start_up(self, axis: str) -> DriveStart:
        """Make the start-up of one drive: its telegram has to serve its mode."""
        return CyclicStart(wrong_mode(self._bench.settings, axis))

    def sampled_ns(self, axis: str, sync_ns: int) -> int:
        """Return when the actual position of this cycle is sampled: T_I before its begin."""
        segment = self._bench.settings.rig.axis[axis].segment
        return sync_ns - instants_of(self._bench.settings, segment).input_ns

    def is_off(self, axis: str) -> bool:
        """Whether the drive of an axis has left operation."""
        return self.links[axis].power in (Power.OFF, Power.FAULT)

    def hexdigest(self) -> str:
        """Return a hash of all images of all segments."""
        return "".join(segment.hexdigest() for segment in self.segments.values())[:64]

    def telegrams(self, axis: str) -> list[Telegram]:
        """Return what the images of an axis carry."""
        telegram = drive_of(self._bench.settings, axis).make().telegram
        return [
            Telegram("outputs", 1, telegram.to_drive),
            Telegram("inputs", 1, telegram.from_drive),
        ]


@once
def profidrive_settings(settings: Settings, name: str) -> ProfidriveSettings:
    """Return what the control knows of the drive of an axis."""
    axis, parameters, drive = settings.rig.axis[name], settings.axis[name], drive_of(settings, name)
    period_us = settings.rig.cycle.period_us
    lead_mm = float(drive.lead_mm)
    return ProfidriveSettings(
        axis=name,
        increments_per_mm=float(drive.per_mm),
        probe_input=drive_input(parameters),
        edge=parameters.word("kenngr.measure.edge"),
        lag_delay_cycles=parameters.integer("antr.nbr_delay_cycles"),
        jump_mm=jump_mm(parameters, drive.jump_factor, period_us),
        acceleration_mm_s2=acceleration_mm_s2(parameters),
        lag_limit_mm=drive.lag_limit_mm or float("inf"),
        fault_reset=drive.fault_reset,
        sensor_age_limit_ms=axis.sensor_age_limit_ms,
        loop=loop_settings(settings, name),
        telegram=drive.make().telegram,
        speed_counts=60 * SPEED_BASE / (parameters.integer(BASE) * lead_mm),
        period_s=period_us * US / S,
        gain=gain_of(settings, name),
        feed_forward=feed_forward(settings, name),
        proves_places=drive.proves_places,
        echo_cycles=phases_of(settings, name).way,
        missing_cycles=drive.missing_cycles,
    )


install = CyclicSegments
"""Installs the cyclic segments of a rig."""
