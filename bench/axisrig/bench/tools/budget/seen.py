"""What one run of a budget showed: the error, and what the plant's truth says of its instants."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.interpolation import cubic
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, TimeNs

METRICS = ("latch_error_um", "contact_velocity_mm_s", "contact_to_latch_ms", "source_error_um")
NEEDED = METRICS[:2]
"""Without them there is no budget; the others are there or not with the source of the value."""


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
    """The numbers of a run. source_um: published less true position at the instant that a PLC
    source gives; latch_ms: from the contact to the latch of the drive; each None without one.
    """

    error_um: float
    velocity_mm_s: float
    latch_ms: float | None
    source_um: float | None
    track: Track | None

    @property
    def way_um(self) -> float | None:
        """True way from the contact to the instant that a PLC source gives.

        The published value is not in it: it is in both errors.
        """
        return None if self.source_um is None else self.error_um - self.source_um

    def moved_um(self, begin_ms: float, end_ms: float) -> float:
        """Return the true way between two instants after the contact: v t + a t^2/2 in a ramp."""
        if self.track is None:
            return self.velocity_mm_s * (end_ms - begin_ms)
        return self.track.position_um(end_ms) - self.track.position_um(begin_ms)


def see(result: CaseResult, axis: str) -> Seen:
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
    track = _track(result, axis)
    return Seen(found[error], found[velocity], found.get(latch), found.get(source), track)


def _track(result: CaseResult, axis: str) -> Track | None:
    if result.facts is None or result.series is None:
        return None
    observed = Observed(result.facts, result.series)
    seen = touch(observed, axis)
    if seen is None or seen.contact is None:
        return None
    at_ns = seen.contact.time_ns
    touches = [
        contact
        for probe in observed.probes_of(seen.run)
        for contact in probe.contacts
        if contact.time_ns <= at_ns
    ]
    edge_ns = at_ns if seen.edge_ns is None else seen.edge_ns
    inside = slice(observed.index_at(at_ns), None)
    rows = range(*inside.indices(len(observed)))
    return Track(
        [observed.time_ns(row) for row in rows],
        [float(value) for value in observed.column(axis, "truth_mm", inside)],
        [float(value) for value in observed.column(axis, "velocity_mm_s", inside)],
        at_ns,
        len(touches),
        (edge_ns - at_ns) / MS,
    )
