"""Drives on wires: what rig and machine ask of the family."""

from collections.abc import Sequence
from functools import partial
from hashlib import sha256

from tests.exercise.wire.control import AtOnceStart, Wire, WireDrive, Wires, WireWatch
from tests.exercise.wire.keys import SegmentTable
from tests.exercise.wire.servo import WireServo

from axisrig.bench.drive.axis.drive import VirtualDrive
from axisrig.bench.machine.families import Bench, Installed
from axisrig.bench.rig.families import RigFamily
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.time.clock import US


def _axes(settings: Settings) -> list[str]:
    """Axes on bundles of wires, whatever their drives are."""
    axes, segments = settings.rig.axis, settings.segment
    return [n for n, axis in axes.items() if isinstance(segments[axis.segment], SegmentTable)]


class OnWires(RigFamily):
    """What a rig asks of drives on wires."""

    def check(self, settings: Settings) -> None:
        """A wire has one input."""
        for name in _axes(settings):
            if settings.rig.axis[name].probe_2 is not None:
                message = f"axis {name}: a drive on a wire has one input"
                raise rig_error(settings.files, ("axis", name, "probe_2"), message)

    def describe(self, settings: Settings) -> Sequence[str]:
        """Say what the wires are."""
        return [f"axis {name}: on a wire of its own" for name in _axes(settings)]


class WiresOfMachine(Installed):
    """The drives on wires of one machine."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._sent: list[str] = []
        settings = bench.settings
        links, drives = dict[str, WireDrive](), dict[str, VirtualDrive]()
        bundles = {n: t for n, t in settings.segment.items() if isinstance(t, SegmentTable)}
        carriers = {name: Wires(name, []) for name in bundles}
        for name in _axes(settings):
            axis, parameters = settings.rig.axis[name], settings.axis[name]
            drive, wire = settings.rig.drive[axis.drive], Wire()
            known = DriveSettings(
                name,
                float(drive.facts().units_per_mm),
                drive_input(parameters),
                parameters.word("kenngr.measure.edge"),
                parameters.integer("antr.nbr_delay_cycles"),
            )
            links[name] = WireDrive(known, wire)
            signal, _ = bench.beside.probes(name)
            period_ns = settings.rig.cycle.period_us * US
            seen = bench.beside.axis(name)
            servo = WireServo(wire, seen, signal, bench.scheduler, period_ns)
            drives[name] = servo
            carriers[axis.segment].ends += [servo.exchange, partial(self._note, name, wire)]
        self.links, self.drives, self.carriers, self._links = links, drives, carriers, links

    def _note(self, axis: str, wire: Wire) -> None:
        self._sent.append(f"{axis} {wire};")

    def watch(self, axis: str) -> WireWatch:
        """Make the watch over one wire; none is ever cut."""
        return WireWatch(self._links[axis], lambda: False)

    def hexdigest(self) -> str:
        """Return a hash of what went over the wires."""
        return sha256("".join(self._sent).encode()).hexdigest()

    def start_up(self, axis: str) -> AtOnceStart:
        """Make the start-up of one drive."""
        return AtOnceStart()


FAMILY = OnWires()
install = WiresOfMachine
