"""`axisrig budget`: which cause has which share of the error of a measured value.

A row is run as it is, and again with causes switched off, all with its seed. What a cause adds is
the difference; the closed form beside it comes from the settings and from the instants and the
motion of the plant's truth, not from measured values. Causes are `causes.csv`, in the order in
which they act between the contact and the published value.

Switched off alone, a cause leaves what it adds to all others. Switched off one after the other from
the last one on, the differences and what is left add up to the error. Where both disagree by more
than an increment, causes act on each other, and their shares are means over all orders
(`combining`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.signal_sources import HELD, STAMPED
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.causes import (
    ROUNDING,
    Active,
    Cause,
    active_causes,
    has_finer_encoder,
    increment_of_value_um,
    measuring_axis,
    motion_causes,
)
from axisrig.bench.tools.budget.closed_forms import bound_um, expected_um
from axisrig.bench.tools.budget.combining import USUAL, combined
from axisrig.bench.tools.budget.combining import Runs as CausesOff
from axisrig.bench.tools.budget.instants import UNIT_UM, is_handed
from axisrig.bench.tools.budget.observed_run import METRICS, Seen, see
from axisrig.kernel.errors import UserError

_ANY = "-1e15 .. 1e15"
_CLOSE = 0.01
"""A share is its closed form when it is within 1 % of it, or within an increment."""

RunCases = Callable[[Sequence[Case]], Iterable[CaseResult]]
"""Runs cases and gives their results in the same order."""
Off = frozenset[int]
"""Which of the causes that are on are switched off in a run, by their places."""

CALCULATED = "cycles"
"""Place of what no switch takes away."""

CYCLES = Cause(
    *("CNC cycle", CALCULATED, "plc", "", "", "", "", "", "source", "random"),
    "from the edge to the SYNC whose actual value the CNC takes; calculated, it cannot be off",
    "docs/measuring-sources.md",
)
SAMPLED = Cause(
    *("digital input", CALCULATED, "input", "", "", "", "", "", "source", "random"),
    "from the edge to the SYNC that samples the level (60FD); calculated, it cannot be off",
    "docs/measuring-sources.md",
)
BETWEEN = Cause(
    *("position history", CALCULATED, "terminal", "", "", "", "", "", "source", "systematic"),
    "a cubic through the positions at four SYNCs, where the acceleration changes; calculated, it"
    " cannot be off",
    "docs/measuring-sources.md",
)

ROUNDED = Cause(
    *("encoder", CALCULATED, "drive", "", "", "", "", "", ROUNDING, "random"),
    "rounding to increments of what the drive latches, where no key alone makes them finer:"
    " published less true position at the latch",
    "docs/touch-probe.md",
    "resolution (GUM F.2.2.1)",
)


@dataclass(frozen=True)
class Share:
    """What a cause adds, um; positive towards larger positions.

    setting: what it is set to, in words. alone_um: the error less that without the cause.
    in_turn_um: the same with all later causes off. expected_um: closed form, None without one.
    bound_um: how large it may be where only that is known; None without one.
    combined_um: mean over all orders, None where no causes act on each other. interacts: whether
    it is one of those that do.
    """

    cause: Cause
    setting: str
    alone_um: float
    in_turn_um: float
    expected_um: float | None
    bound_um: float | None
    combined_um: float | None = None
    interacts: bool = False

    def differs_um(self, increment_um: float) -> float | None:
        """Return how far it is off its closed form or outside its bound, None where it is not."""
        if self.bound_um is not None:
            over_um = abs(self.in_turn_um) - self.bound_um
            return over_um if over_um > increment_um else None
        if self.expected_um is None:
            return None
        off_um = self.in_turn_um - self.expected_um
        is_close = abs(off_um) <= max(_CLOSE * abs(self.expected_um), increment_um)
        return None if is_close else off_um


@dataclass(frozen=True)
class Budget:
    """The shares of one row, of the causes that are on, in the order in which they act.

    error_um: published less true position at the contact. left_um: the error with all of them off.
    velocity_mm_s: true velocity at the contact. increment_um: of the motor encoder, of what a drive
    latches, or of a position that a PLC hands over.
    quantum_um: what may be left: an increment, or the way in the cycles of PLC and CNC where
    nothing says more.
    frame_log_sha256: of the run with all causes as they are. not_combined: causes that may act on
    each other and were switched off in turn only, as more runs were not allowed. kept_on: causes
    without which there is no value.
    """

    run: str
    axis: str
    error_um: float
    velocity_mm_s: float
    increment_um: float
    left_um: float
    shares: tuple[Share, ...]
    frame_log_sha256: str = ""
    quantum_um: float = 0.0
    not_combined: tuple[str, ...] = ()
    kept_on: tuple[str, ...] = ()

    @property
    def largest(self) -> Share | None:
        """The cause with the largest share, None without causes or where all are below an
        increment. What follows from the cycles of the rig alone is none of them.
        """
        causes = [share for share in self.shares if share.cause.place != CALCULATED]
        found = max(causes, key=lambda share: abs(share.in_turn_um), default=None)
        return found if found and abs(found.in_turn_um) > self.increment_um else None

    @property
    def interacting(self) -> tuple[Share, ...]:
        """Causes whose share depends on the others by more than an increment."""
        return tuple(share for share in self.shares if share.interacts)

    @property
    def is_explained(self) -> bool:
        """Whether what is left with all causes off is within what one value can resolve."""
        return abs(self.left_um) <= max(self.quantum_um, self.increment_um)

    @property
    def differing(self) -> tuple[Share, ...]:
        """Shares that are neither within 1 % of their closed form nor within an increment."""
        return tuple(
            share for share in self.shares if share.differs_um(self.increment_um) is not None
        )


class _Runs:
    """Runs of a row with causes off, each made once."""

    def __init__(self, case: Case, axis: str, run_cases: RunCases) -> None:
        self._case, self._axis, self._run_cases = case, axis, run_cases
        self.active: list[Active] = []
        self.frames = ""
        self._seen: dict[Off, Seen] = {}
        self._made = 0

    def make(self, offs: Iterable[Off]) -> None:
        """Run what is not there yet. Raises UserError where a run gives no measured value."""
        wanted = [off for off in dict.fromkeys(offs) if off not in self._seen]
        cases = {}
        for number, off in enumerate(wanted, self._made):
            changed = {
                column: value
                for place in sorted(off)
                for column, value in self.active[place].off.items()
            }
            cases[f"{self._case.run}-budget-{number:03d}"] = off, changed
        self._made += len(wanted)
        made = [
            _without(self._case, self._axis, run, changed) for run, (_, changed) in cases.items()
        ]
        for result in self._run_cases(made):  # in any order
            off = cases[result.case.run][0]
            self._seen[off] = see(result, self._axis, settings_of(result.case))
            self.frames = self.frames if off else result.frame_log_sha256

    def forget(self) -> None:
        """Forget all runs but the one with every cause on: causes have other places now."""
        self._seen = {off: seen for off, seen in self._seen.items() if not off}

    def __getitem__(self, off: Iterable[int]) -> Seen:
        self.make([frozenset(off)])
        return self._seen[frozenset(off)]

    def error_um(self, off: Iterable[int]) -> float:
        """Return the error with some causes off."""
        return self[off].error_um


def make_budget(case: Case, axis: str | None, run_cases: RunCases, most: int = USUAL) -> Budget:
    """Run a row with causes on and off, and return the shares.

    axis: of the measured value; None where the rig has one axis with a probe. most: runs in
    combination, of causes that act on each other. Raises UserError for a rig or an axis without a
    probe, and where the row gives no measured value.
    """
    settings = settings_of(case)
    axis = measuring_axis(settings, axis)
    runs = _Runs(case, axis, run_cases)
    whole = runs[()]
    runs.active, kept_on = _with_motion(runs, _causes_of(case, settings, axis, whole))
    count = len(runs.active)
    runs.make(
        [frozenset([place]) for place in range(count)] + [_from(p, count) for p in range(count)]
    )
    increment_um = increment_of_value_um(settings, axis)
    if whole.source == HELD and is_handed(settings):
        increment_um = max(increment_um, UNIT_UM)
    shares = []
    for place, each in enumerate(runs.active):
        later, without = runs[_from(place + 1, count)], runs[_from(place, count)]
        shares.append(
            Share(
                each.cause,
                each.setting,
                whole.error_um - runs.error_um([place]),
                later.error_um - without.error_um,
                expected_um(each, settings, axis, later, without),
                bound_um(each, settings, axis, whole, increment_um),
            )
        )
    shares, left_out = _combine(runs, shares, increment_um, most)
    left = runs[range(count)]
    left_um = left.error_um
    if left.way_um is not None and abs(left.way_um) > increment_um:
        left_um -= left.way_um
        shares += _of_cycles(settings, left, any(s.interacts for s in shares))
    elif left.latch_ms is not None and not has_finer_encoder(settings, axis):
        shares.append(_of_rounding(left, increment_um, any(s.interacts for s in shares)))
        left_um -= shares[-1].in_turn_um
    return Budget(
        case.run,
        axis,
        whole.error_um,
        whole.velocity_mm_s,
        increment_um,
        left_um,
        tuple(shares),
        runs.frames,
        _quantum_um(settings, whole, increment_um),
        left_out,
        kept_on,
    )


def _from(place: int, count: int) -> Off:
    return frozenset(range(place, count))


def _combine(
    runs: _Runs, shares: list[Share], increment_um: float, most: int
) -> tuple[list[Share], tuple[str, ...]]:
    """Give the shares their means over the orders, where causes act on each other.

    Return with them the names of those that were not combined, since that needs more runs than
    are allowed. The rounding to increments is off throughout: it is a share of its own.
    """
    rounding = [place for place, each in enumerate(runs.active) if each.cause.form == ROUNDING]
    found = combined(
        CausesOff(len(shares), runs.make, runs.error_um, frozenset(rounding)), increment_um, most
    )
    names = tuple(shares[place].cause.cause for place in sorted(found.left_out))
    if not found.interacting:
        return shares, names
    return [
        replace(
            share,
            combined_um=found.shares_um.get(place, share.alone_um),
            interacts=place in found.interacting,
        )
        for place, share in enumerate(shares)
    ], names


def _causes_of(case: Case, settings: Settings, axis: str, whole: Seen) -> list[Active]:
    found = active_causes(
        case,
        settings,
        axis,
        whole.latch_ms is not None,
        is_external=whole.source == HELD,
        farthest_mm=whole.farthest_mm,
    )
    if whole.track is not None:
        found += motion_causes(
            settings,
            axis,
            is_after_signal=whole.is_after_signal,
            gains_speed=whole.gains_speed,
            speed_mm_s=whole.velocity_mm_s if whole.source == STAMPED else None,
        )
    return found


def _with_motion(runs: _Runs, found: list[Active]) -> tuple[list[Active], tuple[str, ...]]:
    """Leave out the run-up or braking without which there is no value; return their names too.

    An axis that does not brake may be at its target before the signal comes.
    """
    kept: list[str] = []
    for each in [active for active in found if active.cause.place == "motion"]:
        runs.active = found
        try:
            runs.make([frozenset([found.index(each)])])
        except UserError:
            runs.forget()
            kept.append(each.cause.cause)
            found = [other for other in found if other is not each]
    return found, tuple(kept)


def _of_rounding(left: Seen, increment_um: float, is_combined: bool) -> Share:
    """Return what is left between a value and the true position at the instant of its latch."""
    um = left.error_um - left.moved_um(0.0, left.latch_ms or 0.0)
    setting = f"increments of {increment_um:.4g} um"
    return Share(ROUNDED, setting, um, um, None, increment_um, um if is_combined else None)


def _of_cycles(settings: Settings, left: Seen, is_combined: bool) -> list[Share]:
    """Return what no switch takes away: the cycle of the CNC, and of the level in a telegram."""
    assert left.way_um is not None
    cycle, way_um, shares = settings.rig.cycle, left.way_um, []

    def share(cause: Cause, setting: str, um: float) -> Share:
        return Share(cause, setting, um, um, None, None, um if is_combined else None)

    if left.sampled_ms is not None:
        sampled_um = left.moved_um(0.0, left.sampled_ms)
        shares.append(share(SAMPLED, f"SYNC every {cycle.period_us} us", sampled_um))
        way_um -= sampled_um
    if left.between_um:
        setting = f"positions every {cycle.period_us} us"
        return [*shares, share(BETWEEN, setting, way_um)]
    setting = f"period {cycle.period_us} us, SYNC {cycle.cycle_offset_us} us before the cycle"
    return [*shares, share(CYCLES, setting, way_um)]


def _quantum_um(settings: Settings, whole: Seen, increment_um: float) -> float:
    """Return what may be left of an error: an increment where the instant of the value is known."""
    task = settings.rig.plc_task
    if whole.latch_ms is not None or whole.way_um is not None or task is None:
        return increment_um
    periods_us = settings.rig.cycle.period_us + task.period_us
    return abs(whole.velocity_mm_s) * periods_us * 1e-3


def _without(case: Case, axis: str, run: str, changed: Mapping[str, str | None]) -> Case:
    """Return the case with columns changed, judged by the metrics that the shares need."""
    item = partial(_named, case)
    gone = {item(column) for column in changed}
    kept = {column: value for column, value in case.inputs.items() if item(column) not in gone}
    given = {column: value for column, value in changed.items() if value is not None}
    return replace(
        case,
        run=run,
        inputs={**kept, **given},
        checks=tuple(parse_check(f"{name}:{axis}", _ANY, "") for name in METRICS),
        expected=(),
        sampled=(),
    )


def _named(case: Case, column: str) -> tuple[str, str, str]:
    """Return what a column sets, without the unit of its name."""
    item = parse_column(column, case.inputs.get(column, "0"))
    return item.kind, item.target, item.name
