"""How many cycles the loop is dead: from the arithmetic of a rig, and from its frames.

o(k), the offset of cycle k, leaves in cycle k (optimized_scheduling 1) or k + 1, acts at the next
SYNC and is reached at the one after it, since the drive interpolates from one set position to the
next; the sensor value of that SYNC is read in its own cycle. So what is computed in cycle k is seen
in cycle k + 2 or k + 3, one or two cycles later than in a loop without dead time, n = 1 or 2.
Sources: docs/architecture.md, "One order"; P-AXIS-00509.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

from axisrig.kernel.time.clock import TimeNs

# Sent in a cycle, acting at the next SYNC, reached at the one after it
WAY_CYCLES = 2
# A step counts as one when the value was constant for so many cycles before it
QUIET_CYCLES = 3


@dataclass(frozen=True)
class DeadCycles:
    """reaction: cycles from the one that reads a sensor value to the one that sends the offset.
    way: from there to the SYNC whose sensor value shows it. age: by how much the value of the
    sensor is older than that of the motor encoder, part of the way.
    """

    reaction: int
    way: int
    age: int = 0

    @property
    def dead(self) -> int:
        """Return n: a loop without dead time has a way of one cycle."""
        return self.reaction + self.way - 1


def predicted(
    *, is_optimized: bool, sensor_age_cycles: int = 0, every: int = 1, late_cycles: int = 0
) -> DeadCycles:
    """Return the dead cycles of a rig.

    late_cycles: that the carrier adds to the way (`bench.oracles.phases`).
    sensor_age_cycles: of 60E4 or of the variable on its way. every: 60E4 comes with every so many
    SYNCs only (transmission type 2 to 240); what a value has set off is then shown by the first
    later value that can.
    """
    reaction = 0 if is_optimized else 1
    whole = reaction + WAY_CYCLES + sensor_age_cycles + late_cycles
    whole = -(-whole // every) * every
    return DeadCycles(reaction, whole - reaction, sensor_age_cycles)


@dataclass(frozen=True)
class Sent:
    """One value on the bus: end of its frame, increments."""

    time_ns: TimeNs
    value: int


@dataclass(frozen=True)
class Measured:
    """Dead cycles from frames. seen_ns, sent_ns, shown_ns: frames of the first sensor value that
    changed, of the first set position that answers it, of the first sensor value that shows that.
    None where the record has no such frame.
    """

    seen_ns: TimeNs | None
    sent_ns: TimeNs
    shown_ns: TimeNs
    cycles: DeadCycles

    @property
    def way_ns(self) -> TimeNs:
        """Time from the frame of the set position to that of the sensor value."""
        return self.shown_ns - self.sent_ns


class NotMeasurableError(Exception):
    """The frames do not show dead cycles; the text says why."""


class _Heard:
    """Values in the order of the bus, read on as far as they are asked for."""

    def __init__(self, values: Iterable[Sent]) -> None:
        self._coming = iter(values)
        self._read: list[Sent] = []

    def __getitem__(self, index: int) -> Sent:
        return self._read[index]

    def has(self, index: int) -> bool:
        """Whether there are so many; they are read then."""
        missing = index + 1 - len(self._read)
        self._read += islice(self._coming, max(missing, 0))
        return index < len(self._read)

    def first_change(self, from_ns: TimeNs, quiet: int) -> int | None:
        """Return the first value at or after an instant that differs from the one before it."""
        index = 1
        while self.has(index):
            now, before = self._read[index], self._read[index - 1]
            if now.time_ns >= from_ns and abs(now.value - before.value) > quiet:
                return index
            index += 1
        return None


def measured(
    targets: Iterable[Sent], sensor: Iterable[Sent], period_ns: TimeNs, quiet_increments: int = 0
) -> Measured:
    """Find the dead cycles around the first answer to a step of the sensor value.

    targets: 607A of each cycle, sensor: 60E4, both in order and read as far as needed; values that
    repeat the one before may be left out. quiet_increments: changes of the sensor value up to this
    are none (noise). The set position must be constant before the step and the sensor value between
    the step and the answer. Raises NotMeasurableError.
    """
    return _measured(_Heard(targets), _Heard(sensor), period_ns, quiet_increments)


def _measured(
    targets: _Heard, sensor: _Heard, period_ns: TimeNs, quiet_increments: int
) -> Measured:
    seen = sensor.first_change(0, quiet_increments)
    if seen is None:
        raise NotMeasurableError("the sensor value never changed by more than its noise")
    sent = targets.first_change(sensor[seen].time_ns, 0)
    if sent is None:
        raise NotMeasurableError("no set position answered the sensor value")
    sent_ns = targets[sent].time_ns
    if targets.first_change(0, 0) != sent:  # else the change is an answer itself
        raise NotMeasurableError(
            "the set position was not constant before the sensor value changed: no step"
        )
    shown = sensor.first_change(sent_ns, quiet_increments)
    if shown is None:
        raise NotMeasurableError("no sensor value showed the set position")
    between = [one for at in range(seen + 1, shown) if (one := sensor[at]).time_ns < sent_ns]
    if any(abs(one.value - sensor[seen].value) > quiet_increments for one in between):
        raise NotMeasurableError("the sensor value went on changing: no step")
    step, back = (sensor[at].value - sensor[at - 1].value for at in (seen, shown))
    if sensor[seen].time_ns - sensor[0].time_ns < (QUIET_CYCLES - 0.5) * period_ns:
        raise NotMeasurableError("the sensor value was not constant before its change: no step")
    if step * back > 0:  # an answer that converges goes the other way
        raise NotMeasurableError("the sensor value went on changing: no step")
    shown_ns, seen_ns = sensor[shown].time_ns, sensor[seen].time_ns
    reaction = sent_ns // period_ns - seen_ns // period_ns
    way = shown_ns // period_ns - sent_ns // period_ns
    return Measured(seen_ns, sent_ns, shown_ns, DeadCycles(reaction, way))
