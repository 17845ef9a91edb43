"""`axisrig budget`: which cause has which share of the error of a measured value.

A row is run as it is, and again with causes switched off, all with its seed. What a cause adds is
the difference; the closed form beside it comes from the settings and from the instants and speeds
of the plant's truth, not from measured values. Causes are `causes.csv`, in the order in which they
act between the contact and the published value.

Switched off alone, a cause leaves what it adds to all others. Switched off one after the other from
the last one on, the differences and what is left add up to the error. Where both disagree by more
than an increment, causes act on each other.
"""

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from math import copysign

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.assignment import Assignment, parse_assignment, parse_column
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.reports.budget.section import COLUMNS

_METRICS = ("latch_error_um", "contact_velocity_mm_s", "contact_to_latch_ms")
_ANY = "-1e15 .. 1e15"
_UM_PER_MM = 1e3

RunCases = Callable[[Sequence[Case]], Iterable[CaseResult]]
"""Runs cases and gives their results in the same order."""


@dataclass(frozen=True)
class Cause:
    """One row of `causes.csv`.

    place: probe, axis (its plant), drive, or set (its parameter list). key, unit: what is set
    there; off: the value that switches the cause off. form: its closed form, empty without one.
    effect: systematic or random, as the GUM has these words (B.2.21, B.2.22).
    """

    cause: str
    place: str
    key: str
    unit: str
    off: str
    form: str
    effect: str
    meaning: str
    source: str


@cache
def causes() -> tuple[Cause, ...]:
    """Return the causes in the order in which they act."""
    text = resources.files(__package__).joinpath("causes.csv").read_text(encoding="utf-8")
    return tuple(Cause(**row) for row in csv.DictReader(text.splitlines()))


@dataclass(frozen=True)
class Share:
    """What a cause adds, um; positive towards larger positions.

    setting: what it is set to, in words. alone_um: the error less that without the cause.
    in_turn_um: the same with all later causes off. expected_um: closed form, None without one.
    bound_um: how far the closed form may be off; None without one.
    """

    cause: Cause
    setting: str
    alone_um: float
    in_turn_um: float
    expected_um: float | None
    bound_um: float | None


@dataclass(frozen=True)
class Budget:
    """The shares of one row, of the causes that are on, in the order in which they act.

    error_um: published less true position at the contact. left_um: the error with all of them off.
    velocity_mm_s: true velocity at the contact. increment_um: of the motor encoder.
    frame_log_sha256: of the run with all causes as they are.
    """

    run: str
    axis: str
    error_um: float
    velocity_mm_s: float
    increment_um: float
    left_um: float
    shares: tuple[Share, ...]
    frame_log_sha256: str = ""

    @property
    def largest(self) -> Share | None:
        """The cause with the largest share, None without causes or where all are below an
        increment.
        """
        found = max(self.shares, key=lambda share: abs(share.in_turn_um), default=None)
        return found if found and abs(found.in_turn_um) > self.increment_um else None

    @property
    def interacting(self) -> tuple[Share, ...]:
        """Causes whose share depends on the others by more than an increment."""
        return tuple(
            share
            for share in self.shares
            if abs(share.alone_um - share.in_turn_um) > self.increment_um
        )


@dataclass(frozen=True)
class _Seen:
    """What a run of the row showed."""

    error_um: float
    velocity_mm_s: float
    latch_ms: float


def make_budget(case: Case, axis: str | None, run_cases: RunCases) -> Budget:
    """Run a row with causes on and off, and return the shares.

    axis: of the measured value; None where the rig has one axis with a probe. Raises UserError for
    a rig or an axis without a probe, and where the row gives no measured value.
    """
    settings = settings_of(case)
    axis = _axis(settings, axis)
    active = [
        (cause, column, value)
        for cause in causes()
        if (value := _setting(settings, axis, cause)) is not None
        for column in [_column(settings, axis, cause)]
    ]
    offs = [frozenset[int]()]
    offs += [frozenset([place]) for place in range(len(active))]
    offs += [frozenset(range(place, len(active))) for place in range(len(active))]
    wanted = list(dict.fromkeys(offs))
    cases = [
        _without(case, axis, number, {active[place][1]: active[place][0].off for place in off})
        for number, off in enumerate(wanted)
    ]
    results, frames = {}, {}
    for result in run_cases(cases):  # in any order
        results[result.case.run] = _seen(result)
        frames[result.case.run] = result.frame_log_sha256
    seen = {off: results[case.run] for off, case in zip(wanted, cases, strict=True)}
    whole = seen[frozenset()]
    table = settings.rig.drive[settings.rig.axis[axis].drive]
    increment_um = table.lead_mm / table.encoder_increments * _UM_PER_MM
    shares = []
    for place, (cause, _, value) in enumerate(active):
        alone, later = seen[frozenset([place])], seen[frozenset(range(place + 1, len(active)))]
        without = seen[frozenset(range(place, len(active)))]
        expected = _expected_um(cause, value, later, without)
        shares.append(
            Share(
                cause,
                f"{cause.key} {value} {cause.unit}".rstrip(),
                whole.error_um - alone.error_um,
                later.error_um - without.error_um,
                expected,
                _bound_um(cause, settings, axis, whole, increment_um),
            )
        )
    left = seen[frozenset(range(len(active)))]
    return Budget(
        case.run,
        axis,
        whole.error_um,
        whole.velocity_mm_s,
        increment_um,
        left.error_um,
        tuple(shares),
        frames[cases[0].run],
    )


def _axis(settings: Settings, axis: str | None) -> str:
    measuring = [name for name, table in settings.rig.axis.items() if table.probe_1]
    if axis is None and len(measuring) == 1:
        return measuring[0]
    if axis not in measuring:
        raise UserError(
            "which axis has the measured value?"
            if measuring
            else "no axis of the rig has a probe at input 1 of its drive",
            file=settings.files[0],
            value=axis,
            allowed=measuring or "probe_1 of an [axis]",
            hint="--axis Z" if measuring else None,
        )
    return axis


def _place(settings: Settings, axis: str, cause: Cause) -> str:
    """Return the instance, the drive or the axis whose key a cause is."""
    table = settings.rig.axis[axis]
    assert table.probe_1 is not None, "the axis has a probe"
    places = {"probe": table.probe_1, "axis": table.plant, "drive": table.drive, "set": axis}
    return places[cause.place]


def _column(settings: Settings, axis: str, cause: Cause) -> str:
    kind = {"probe": "plant", "axis": "plant"}.get(cause.place, cause.place)
    name = f"{cause.key}_{cause.unit}" if cause.unit else cause.key
    return f"{kind}:{_place(settings, axis, cause)}.{name}"


def _setting(settings: Settings, axis: str, cause: Cause) -> str | None:
    """Return what a cause is set to, in its unit; None where it is off or is not there.

    A start value that nobody gives is that of the model, which is 0 for each of them.
    """
    place = _place(settings, axis, cause)
    if cause.place == "set":
        text = str(settings.axis[place].integer(cause.key))
    elif cause.place == "drive":
        value = getattr(settings.rig.drive[place], cause.key)
        text = value if isinstance(value, str) else f"{value:g}"
        if cause.form == "rounding":
            text = str(value)
    else:
        found = _start(settings, place, cause)
        if found is None:
            return None
        text = f"{found.si() / parse_column(f'plant:p.x_{cause.unit}', '1').si():g}"
    return None if text == cause.off else text


def _start(settings: Settings, instance: str, cause: Cause) -> Assignment | None:
    """Return the start value of a plant that counts: the last one of the row, else the rig's."""
    table = settings.rig.plant[instance]
    of_rig = [
        parse_assignment(f"plant:{instance}.{key}={value}") for key, value in table.start.items()
    ]
    of_row = [item for item, _ in settings.start.get(instance, [])]
    fitting = [item for item in (*of_rig, *of_row) if item.name == cause.key]
    return fitting[-1] if fitting else None


def _without(case: Case, axis: str, number: int, changed: Mapping[str, str]) -> Case:
    """Return the case with columns changed, judged by the metrics that the shares need."""
    names = {(item.kind, item.target, item.name) for item in map(parse_column, changed, changed)}
    inputs = {
        column: value
        for column, value in case.inputs.items()
        if (item := parse_column(column, value))
        and (item.kind, item.target, item.name) not in names
    }
    checks = tuple(parse_check(f"{name}:{axis}", _ANY, "") for name in _METRICS)
    return replace(
        case,
        run=f"{case.run}-budget-{number:03d}",
        inputs={**inputs, **changed},
        checks=checks,
        expected=(),
        sampled=(),
    )


def _seen(result: CaseResult) -> _Seen:
    values = []
    for check in result.checks:
        if not isinstance(check.value, int | float):
            reason = result.error or check.note or result.verdict.word
            inputs = " ".join(f"{column}={value}" for column, value in result.case.inputs.items())
            raise UserError(
                f"no {check.check.name} of {result.case.run}: {reason}",
                value=inputs,
                hint="a budget takes apart the value of a measurement run that touches something",
            )
        values.append(float(check.value))
    return _Seen(*values)


def _expected_um(cause: Cause, value: str, later: _Seen, without: _Seen) -> float | None:
    """Return the closed form of a share: a time costs v t, a length has the sign of the motion.

    What is drawn is known by the instant of the latch, which the plant's truth has.
    """
    v_um_s = later.velocity_mm_s * _UM_PER_MM
    match cause.form:
        case "time":
            return v_um_s * float(value) * 1e-6
        case "minus_time":
            return -v_um_s * float(value) * 1e-6
        case "length":
            return copysign(float(value), v_um_s)
        case "drawn":
            return v_um_s * (later.latch_ms - without.latch_ms) * 1e-3
    return None


def _bound_um(
    cause: Cause, settings: Settings, axis: str, whole: _Seen, increment_um: float
) -> float | None:
    """Return how large a share may be where only that is known."""
    if cause.form == "rounding":
        return increment_um
    if cause.form == "sampling":
        table = settings.rig.drive[settings.rig.axis[axis].drive]
        return abs(whole.velocity_mm_s) * _UM_PER_MM * float(table.sample_us) * 1e-6
    return None


def budget_lines(budget: Budget) -> list[str]:
    """Say a budget in lines: a table of the causes, their sum, and the largest."""
    lines = [
        f"{budget.run}, axis {budget.axis}: published value {budget.error_um:+.4f} um from the"
        f" contact, at {abs(budget.velocity_mm_s):g} mm/s towards"
        f" {'smaller' if budget.velocity_mm_s < 0 else 'larger'} positions",
        "",
        f"{'cause':<14} {'setting':<44} {'alone um':>10} {'in turn um':>11} {'closed form um':>15}",
    ]
    for share in budget.shares:
        form = "" if share.expected_um is None else f"{share.expected_um:+.4f}"
        if share.bound_um is not None:
            form = f"+- {share.bound_um:.4f}"
        lines.append(
            f"{share.cause.cause:<14} {share.setting:<44} {share.alone_um:>+10.4f}"
            f" {share.in_turn_um:>+11.4f} {form:>15}"
        )
    total_um = sum(share.in_turn_um for share in budget.shares)
    lines += [
        f"{'all causes':<59} {'':>10} {total_um:>+11.4f}",
        f"{'left with all causes off':<59} {'':>10} {budget.left_um:>+11.4f}",
        "",
    ]
    largest = budget.largest
    lines.append(
        f"largest: {largest.cause.cause}, {largest.cause.meaning} ({largest.setting})"
        if largest
        else f"no cause is larger than an increment of the encoder ({budget.increment_um:.4f} um)"
    )
    if budget.interacting:
        names = ", ".join(share.cause.cause for share in budget.interacting)
        lines.append(f"these act on each other, more than an increment: {names}")
    return lines


def budget_table(budget: Budget) -> list[dict[str, object]]:
    """Return the table of a budget, a row for each cause and one for what is left."""
    rows: list[dict[str, object]] = [
        {
            "run": budget.run,
            "axis": budget.axis,
            "cause": share.cause.cause,
            "setting": share.setting,
            "effect": share.cause.effect,
            "alone_um": share.alone_um,
            "in_turn_um": share.in_turn_um,
            "closed_form_um": share.expected_um,
            "bound_um": share.bound_um,
            "meaning": share.cause.meaning,
            "frame_log_sha256": budget.frame_log_sha256,
        }
        for share in budget.shares
    ]
    left: dict[str, object] = dict.fromkeys(COLUMNS)
    left |= {"run": budget.run, "axis": budget.axis, "cause": "left with all causes off"}
    left |= {"in_turn_um": budget.left_um, "frame_log_sha256": budget.frame_log_sha256}
    return [*rows, left]
