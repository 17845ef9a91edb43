"""How far the probes of a rig give way: the stroke of a probe is a limit of the plant.

The kernel has a stroke of its own (P-AXIS-00086) and keeps its speed to it; what the plant's
probe bears is `stroke_mm` of its `[plant.P]`. Looked at in every NC cycle, with the plant's truth.
Where the rig gives no stroke, a probe that a block drives into the workpiece without measuring is
noted with block, axis and way.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import Final

from axisrig.bench.rig.reading.file import PlantTable, rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import Contact, PlantProbe
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import ArcMove, LinearMove
from axisrig.kernel.time.clock import TimeNs

RESTING_M_S: Final = 1e-9
"""Below this speed an axis has no direction."""


@dataclass
class Deflection:
    """How one contact deflected a probe: how far the axes went on, in the direction they came from.

    mm: largest way since the contact. doubt_mm: how much farther it may have been between two NC
    cycles. beyond_ns: the first cycle with more than the stroke, None when it stayed within.
    block: the one that drove the probe there without measuring, axis: the one that it led farthest
    past the contact; None where a run, or the workpiece, made the contact.
    """

    probe: str
    contact: Contact
    mm: float = 0.0
    doubt_mm: float = 0.0
    beyond_ns: TimeNs | None = None
    block: Block | None = None
    axis: str = ""


def moving(probe: PlantProbe) -> list[PlantAxis]:
    """Return the axes that move a probe; one that is wired to two coordinates moves it once."""
    return list({id(axis): axis for axis in probe.sources}.values())


class _Follower:
    """Follows the axes of one probe from each contact until they are back.

    axes: the name of each axis that moves it; None for a sensor that is no measuring probe.
    """

    def __init__(
        self, name: str, probe: PlantProbe, table: PlantTable, axes: Sequence[str] | None
    ) -> None:
        self.name, self.probe, self.table, self.axes = name, probe, table, axes
        self.deflections: list[Deflection] = []
        self._seen = 0
        self._moving = moving(probe)
        self._rates = [0.0] * len(self._moving)
        self._direction: Sequence[float] | None = None
        self._is_pressed = False

    def look(self, channel: Channel, now_ns: TimeNs, cycle_ns: TimeNs) -> Alarm | None:
        """Follow the motion up to now; return the alarm of a probe that has just broken."""
        motions = [axis.motion for axis in self._moving]
        rates = [motion[1] for motion in motions]
        contacts = self.probe.contacts
        if len(contacts) > self._seen:
            self._seen, self._is_pressed = len(contacts), True
            self._direction = _unit(self._rates) or _unit(rates)
            self.deflections.append(Deflection(self.name, contacts[-1]))
            if self.axes is not None and self._direction is not None:
                self.deflections[-1].block = _driving(channel, self.axes)
        self._rates = rates
        if not self._is_pressed:
            return None
        way_mm = self._way_mm([motion[0] for motion in motions])
        self._is_pressed = way_mm >= 0.0
        now = self.deflections[-1]
        if way_mm > now.mm:
            now.mm, now.doubt_mm = way_mm, hypot(*rates) * 1e3 * cycle_ns * 1e-9 / 2.0
            if now.block is not None:
                now.axis = self._foremost()
        return self._judged(now, now_ns)

    def _way_mm(self, places_m: Sequence[float]) -> float:
        """Return how far the axes have gone on; below 0: they are back on the side they came from.

        From a contact at rest (the workpiece came) every way counts.
        """
        begin = self.deflections[-1].contact.position_mm
        ways = [
            place_m * 1e3 - begin[axis.name]
            for place_m, axis in zip(places_m, self._moving, strict=True)
        ]
        if self._direction is None:
            return hypot(*ways)
        return sum(way * part for way, part in zip(ways, self._direction, strict=True))

    def _foremost(self) -> str:
        """Return the axis that moves most in the direction of the contact."""
        assert self.axes is not None
        parts = self._direction or (0.0,) * len(self.axes)
        return max(zip(parts, self.axes, strict=True), key=lambda part: abs(part[0]))[1]

    def _judged(self, now: Deflection, now_ns: TimeNs) -> Alarm | None:
        stroke_mm = self.table.stroke_mm
        if stroke_mm is None or now.beyond_ns is not None or now.mm <= stroke_mm:
            return None
        is_first = all(each.beyond_ns is None for each in self.deflections)
        now.beyond_ns = now_ns
        if not (self.table.breaks and is_first):
            return None
        lengths = {"deflection_mm": f"{now.mm:.4f}", "stroke_mm": f"{stroke_mm:g}"}
        return Alarm(900072, probe=self.name, **lengths)


def _driving(channel: Channel, axes: Sequence[str]) -> Block | None:
    """Return the block that moves some of these axes while none of them measures."""
    if any(channel.single.measuring_state(axis) is not None for axis in axes):
        return None
    beside = [channel.single.independent.block_of(axis) for axis in axes]
    begun = channel.execution.begun
    on_path = begun.block if isinstance(begun, (LinearMove, ArcMove)) else None
    return next((block for block in beside if block is not None), on_path)


def _unit(rates: Sequence[float]) -> list[float] | None:
    speed = hypot(*rates)
    return [rate / speed for rate in rates] if speed > RESTING_M_S else None


class DeflectionLog:
    """Observer of a channel: follows every probe that reports its contacts, in every NC cycle.

    A probe that breaks (`breaks` of its plant) stops the program with 900072, once.
    """

    def __init__(self, settings: Settings, plant: Plant, period_ns: TimeNs) -> None:
        self._plant, self._period_ns = plant, period_ns
        measuring = _measuring_probes(settings)
        names = {table.plant: name for name, table in settings.rig.axis.items()}
        self._followers = {
            name: _Follower(
                name,
                probe,
                settings.rig.plant[name],
                [names.get(axis.name, axis.name) for axis in moving(probe)]
                if name in measuring
                else None,
            )
            for name, probe in plant.probes.items()
            if probe.roles.has_group("contact")
        }

    def __call__(self, channel: Channel) -> None:
        """Look at the probes after a cycle."""
        for follower in self._followers.values():
            broken = follower.look(channel, self._plant.now_ns, self._period_ns)
            if broken is not None:
                channel.stop(broken)

    def of(self, probe: str) -> list[tuple[Deflection, str]]:
        """Return every deflection of a probe that has contacts, with words where one is to be
        reported: too large, or driven without measuring.
        """
        follower = self._followers[probe]
        return [(each, _in_words(each, follower.table)) for each in follower.deflections]


def _measuring_probes(settings: Settings) -> set[str]:
    """Return the sensors at inputs for a touch probe: of a drive, or of the PLC."""
    axes, task = settings.rig.axis.values(), settings.rig.plc_task
    found = {name for axis in axes for name in (axis.probe_1, axis.probe_2) if name is not None}
    if task is not None and task.terminal is not None:
        found |= set(task.terminal.inputs.values())
    return found


def _in_words(found: Deflection, table: PlantTable) -> str:
    if found.beyond_ns is None:
        if table.stroke_mm is not None or found.block is None or found.mm <= 0.0:
            return ""
        return (
            f"{found.probe}: driven {found.mm:.4f} mm past its contact by axis {found.axis} in"
            f" {found.block.place}, which does not measure; no stroke_mm says whether it bears that"
        )
    broken = "; it is broken" if table.breaks else ""
    return (
        f"{found.probe}: deflected by {found.mm:.4f} mm, more than its stroke of"
        f" {table.stroke_mm:g} mm{broken}"
    )


def check_strokes(settings: Settings, probes: Mapping[str, PlantProbe]) -> None:
    """Refuse a stroke that nothing can watch.

    Raises UserError with file, line and key of the rig.
    """
    for name, table in settings.rig.plant.items():
        if table.stroke_mm is None and not table.breaks:
            continue
        why = ""
        if name not in probes:
            why = "only a probe has a stroke"
        elif not probes[name].roles.has_group("contact"):
            why = "its FMU has no output contact_count: without a contact the stroke has no start"
        elif table.stroke_mm is None:
            why = "a probe that breaks has a stroke: give stroke_mm"
        if why:
            key = "breaks" if table.stroke_mm is None else "stroke_mm"
            raise rig_error(settings.files, ("plant", name, key), f"plant {name}: {why}")
