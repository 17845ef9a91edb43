"""What one run of a budget showed: the error, and what the plant's truth says of its instants."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.judge.latch.truth import Touch, touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.interpolation import cubic
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.causes import probe_of
from axisrig.bench.tools.budget.encoder import (
    between_um,
    history_end_ns,
    is_stamped,
    lost_um,
    noise_number,
)
from axisrig.bench.tools.budget.instants import instants_at_plc
from axisrig.bench.tools.budget.surface import normal_of, way_per_length
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, TimeNs

METRICS = ("latch_error_um", "contact_velocity_mm_s", "contact_to_latch_ms", "source_error_um")
NEEDED = METRICS[:2]
"""Without them there is no budget; the others are there or not with the source of the value."""
_BEFORE = 50
"""So many SYNCs before the contact the motion is kept."""
_STEADY = 2e-3
"""A speed that changes by a smaller share in a cycle is constant: a step of the set position by an
increment of 9.5 nm in 1 ms is 1e-3 of 10 mm/s.
"""


@dataclass(frozen=True)
class Track:
    """True motion of the axis at each SYNC: ns, mm, mm/s. contact_ns: when the probe touched.

    touches: how many contacts the probe has had until then, that one with it. edge_ms: from the
    contact to the edge of the probe.
    """

    times_ns: Sequence[TimeNs]
    position_mm: Sequence[float]
    velocity_mm_s: Sequence[float]
    contact_ns: TimeNs
    touches: int
    edge_ms: float

    def position_um(self, after_ms: float) -> float:
        """Return the true position so long after the contact."""
        at_ns = self.contact_ns + after_ms * MS
        row = min(max(bisect_right(self.times_ns, at_ns) - 1, 0), len(self.times_ns) - 2)
        begin_ns, end_ns = self.times_ns[row], self.times_ns[row + 1]
        ends = (
            self.position_mm[row],
            self.velocity_mm_s[row],
            self.position_mm[row + 1],
            self.velocity_mm_s[row + 1],
        )
        return 1e3 * cubic((at_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9, ends)


@dataclass(frozen=True)
class Seen:
    """The numbers of a run.

    latch_ms: from the contact to the latch of the drive, None without one. source_um: published
    less true position at the instant that a PLC source gives. value_ms: from the contact to the
    instant whose position is published, sampled_ms: to the SYNC that samples the digital input of a
    drive; both may be unknown. per_length: how far the axis moves until the probe is deflected by
    1 along the normal of the surface. between_um: how far the curve through positions at SYNCs is
    off at a time stamp. lost_um: what a position that telegrams have lost differs
    from the true one. noise: number of the noise of the motor encoder in the value.
    is_after_signal: the value is of an instant at which the axis brakes for a signal.
    gains_speed: the speed grows at the contact. source: of the signal, P-AXIS-00516. farthest_mm:
    from 0 that an axis with the same drive has been.
    """

    error_um: float
    velocity_mm_s: float
    latch_ms: float | None
    source_um: float | None
    track: Track | None
    value_ms: float | None = None
    sampled_ms: float | None = None
    per_length: float | None = None
    lost_um: float = 0.0
    between_um: float = 0.0
    noise: float = 0.0
    is_after_signal: bool = False
    gains_speed: bool = False
    source: str = ""
    farthest_mm: float = 0.0

    @property
    def way_um(self) -> float | None:
        """True way from the contact to the instant that a PLC source gives, and what a curve
        through positions is off there. The published value is not in it.
        """
        if self.latch_ms is None and self.value_ms is not None:
            return self.moved_um(0.0, self.value_ms) + self.between_um + self.lost_um
        return None if self.source_um is None else self.error_um - self.source_um

    @property
    def delayed_um(self) -> float | None:
        """True way from the contact to the instant whose position is published."""
        if self.latch_ms is not None:
            return self.moved_um(0.0, self.latch_ms)
        return self.way_um

    def moved_um(self, begin_ms: float, end_ms: float) -> float:
        """Return the true way between two instants after the contact: v t + a t^2/2 in a ramp."""
        if self.track is None:
            return self.velocity_mm_s * (end_ms - begin_ms)
        return self.track.position_um(end_ms) - self.track.position_um(begin_ms)


def see(result: CaseResult, axis: str, settings: Settings) -> Seen:
    """Take what a budget needs out of a run. Raises UserError where it has no measured value."""
    found: dict[str, float] = {}
    for check in result.checks:
        name = check.check.name
        if isinstance(check.value, int | float):
            found[name] = float(check.value)
        elif name in NEEDED:
            reason = result.error or check.note or result.verdict.word
            inputs = " ".join(f"{column}={value}" for column, value in result.case.inputs.items())
            raise UserError(
                f"no {name} of {result.case.run}: {reason}",
                value=inputs,
                hint="a budget takes apart the value of a measurement run that touches something",
            )
    error, velocity, latch, source = METRICS
    numbers = found[error], found[velocity], found.get(latch), found.get(source)
    if result.facts is None or result.series is None:
        return Seen(*numbers, None)
    observed = Observed(result.facts, result.series)
    seen = touch(observed, axis)
    if seen is None or seen.contact is None:
        return Seen(*numbers, None)
    track, farthest_mm = _track(observed, seen, axis), _farthest_mm(observed, axis, settings)
    plain = Seen(*numbers, track, farthest_mm=farthest_mm)
    return _whole(observed, seen, axis, settings, plain)


def _farthest_mm(observed: Observed, axis: str, settings: Settings) -> float:
    """Return how far from 0 any axis with the drive of this one has been."""
    drive = settings.rig.axis[axis].drive
    ends = [
        (float(np.min(values)), float(np.max(values)))
        for name, table in settings.rig.axis.items()
        if table.drive == drive and observed.has(name, "truth_mm")
        for part in observed.parts()
        for values in (part.observed.column(name, "truth_mm", part.inside),)
    ]
    return max((abs(end) for pair in ends for end in pair), default=0.0)


def _whole(observed: Observed, seen: Touch, axis: str, settings: Settings, plain: Seen) -> Seen:
    """Add what follows from the edges of the plant, the cycles and the start values."""
    assert seen.contact is not None
    contact_ns = seen.contact.time_ns
    instants = None
    if plain.latch_ms is None:
        instants = instants_at_plc(observed, seen, axis, settings)
        value_ns = None if instants is None else instants.value_ns
    else:
        value_ns = contact_ns + round(plain.latch_ms * MS)
    if value_ns is None:
        return replace(plain, source=seen.run.sources.get(axis, ""))
    sampled_ns = None if instants is None else instants.sampled_ns
    probe, row = probe_of(settings, axis), observed.index_at(contact_ns)
    normal = normal_of(settings, probe)
    velocity = {axis: observed.value(axis, "velocity_mm_s", row)}
    for name, plant in settings.rig.plant[probe].wire.items():
        for other, table in settings.rig.axis.items():
            if table.plant == plant:
                velocity[name] = observed.value(other, "velocity_mm_s", row)
    after = observed.value(axis, "velocity_mm_s", row + 1)
    signal_ns = seen.run.signal_ns
    is_at_stamp = is_stamped(observed, axis)
    until_ns = history_end_ns(observed, axis, value_ns) if is_at_stamp else value_ns
    return replace(
        plain,
        source=seen.run.sources.get(axis, ""),
        value_ms=(value_ns - contact_ns) / MS,
        sampled_ms=None if sampled_ns is None else (sampled_ns - contact_ns) / MS,
        per_length=None if normal is None else way_per_length(normal, velocity, axis),
        between_um=between_um(observed, axis, value_ns) if is_at_stamp else 0.0,
        lost_um=lost_um(observed, axis, value_ns, is_latched=plain.latch_ms is not None),
        noise=noise_number(
            observed,
            axis,
            settings,
            value_ns,
            None if plain.latch_ms is None else seen.edge_ns,
        ),
        is_after_signal=signal_ns is not None and until_ns > signal_ns,
        gains_speed=abs(after) - abs(velocity[axis]) > _STEADY * abs(velocity[axis]),
    )


def _track(observed: Observed, seen: Touch, axis: str) -> Track:
    """Return the motion from some SYNCs before the contact on: a value may be of before it."""
    assert seen.contact is not None
    at_ns = seen.contact.time_ns
    touches = [
        contact
        for probe in observed.probes_of(seen.run)
        for contact in probe.contacts
        if contact.time_ns <= at_ns
    ]
    edge_ns = at_ns if seen.edge_ns is None else seen.edge_ns
    inside = slice(max(observed.index_at(at_ns) - _BEFORE, 0), None)
    rows = range(*inside.indices(len(observed)))
    return Track(
        [observed.time_ns(row) for row in rows],
        [float(value) for value in observed.column(axis, "truth_mm", inside)],
        [float(value) for value in observed.column(axis, "velocity_mm_s", inside)],
        at_ns,
        len(touches),
        (edge_ns - at_ns) / MS,
    )
