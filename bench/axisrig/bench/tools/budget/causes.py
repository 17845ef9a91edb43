"""The causes of `causes.csv`: which of them are on in a row, and what switches each off."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.plan.case import Case
from axisrig.bench.rig.canopen.keys import ENCODER_RANGE, DriveTable
from axisrig.bench.rig.ethercat.members import ec_segments, segment_of, terminal_on
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.instants import is_handed
from axisrig.bench.tools.budget.motion import (
    braking_words,
    run_up_words,
    without_braking,
    without_run_up,
)
from axisrig.bench.tools.budget.starts import start_value
from axisrig.kernel.errors import UserError

ASSUMED, ROUNDING = "=", "rounding"
_UM_PER_MM = 1e3


@dataclass(frozen=True)
class Cause:
    """One row of `causes.csv`.

    place: probe, axis (its plant), drive, set (its parameter list), plc (its task), line (its
    segment where that is EtherCAT), variable (V.E.), fault (the columns `fault:` of the row), or
    motion (`motion`). needs: drive: the drive
    latches the value; input: it sees the signal; plc: the signal comes by the PLC; terminal: by a
    terminal of its own; external: PLC_EXT_LATCH_CONTROL; empty: any value. key, unit: what is set
    there, several keys apart by spaces; off: the values that switch the cause off, `=` and a key:
    what this key has. default: what the model has where nobody gives a value, empty is off. model:
    ending of the FMU that has the key, empty: any. form: its closed form, empty without one.
    effect: systematic or random, as the GUM has these words (B.2.21, B.2.22). term: what ISO 230-10
    or the GUM calls it, where they have a word for it.
    """

    cause: str
    place: str
    needs: str
    key: str
    unit: str
    off: str
    default: str
    model: str
    form: str
    effect: str
    meaning: str
    source: str
    term: str = ""


@dataclass(frozen=True)
class Active:
    """A cause that is on. value: of its first key. off: column -> value, None: without it."""

    cause: Cause
    value: str
    setting: str
    off: Mapping[str, str | None]


@cache
def causes() -> tuple[Cause, ...]:
    """Return the causes in the order in which they act."""
    text = resources.files(__package__).joinpath("causes.csv").read_text(encoding="utf-8")
    return tuple(Cause(**row) for row in csv.DictReader(text.splitlines()))


def measuring_axis(settings: Settings, axis: str | None) -> str:
    """Return the axis of the measured value; axis: as it was asked for.

    Raises UserError where the rig has no probe, and where an axis has to be named.
    """
    wired = [name for name, table in settings.rig.axis.items() if table.probe_1]
    if not wired and terminal_probe(settings) is not None:
        wired = [name for name in settings.rig.axis if settings.axis[name].flag("kenngr.messachse")]
    if axis is None and len(wired) == 1:
        return wired[0]
    if axis not in wired:
        raise UserError(
            "which axis has the measured value?"
            if wired
            else "no axis of the rig has a probe at input 1 of its drive or at a terminal",
            file=settings.files[0],
            value=axis,
            allowed=wired or "probe_1 of an [axis], input_1 of [plc.terminal]",
            hint=f"--axis {wired[0]}" if wired else None,
        )
    return axis


def terminal_probe(settings: Settings) -> str | None:
    """Return the first probe at the terminal of the PLC, None without one."""
    task = settings.rig.plc_task
    if task is None or task.terminal is None:
        return None
    return next(iter(task.terminal.inputs.values()), None)


def active_causes(
    case: Case,
    settings: Settings,
    axis: str,
    is_latched: bool,
    *,
    is_external: bool = False,
    farthest_mm: float = 0.0,
) -> list[Active]:
    """Return the causes that are on. is_latched: the drive has latched the value. is_external: the
    source is PLC_EXT_LATCH_CONTROL. farthest_mm: from 0 that an axis with the same drive has been.
    Those of the motion are not among them (`motion_causes`).
    """
    task = settings.rig.plc_task
    at_terminal = terminal_probe(settings) is not None
    there = {
        "": True,
        "drive": is_latched,
        "input": is_latched or not at_terminal,
        "plc": not is_latched and task is not None,
        "terminal": not is_latched and at_terminal,
        "external": is_external and is_handed(settings),
    }
    known = (
        _in_reach(settings, axis, cause, farthest_mm)
        for cause in causes()
        if cause.form != ROUNDING or has_finer_encoder(settings, axis)
    )
    found = [_active(case, settings, axis, cause) for cause in known if there[cause.needs]]
    return [each for each in found if each is not None]


def has_finer_encoder(settings: Settings, axis: str) -> bool:
    """Whether finer increments are a key of the drive alone.

    Else its telegram, its list or the width of its counter go with them.
    """
    return isinstance(settings.rig.drive[settings.rig.axis[axis].drive], DriveTable)


def increment_of_value_um(settings: Settings, axis: str) -> float:
    """Return the increment of what the drive of an axis latches, um."""
    table = settings.rig.drive[settings.rig.axis[axis].drive]
    if isinstance(table, DriveTable):
        return float(table.lead_mm / table.encoder_increments * _UM_PER_MM)
    facts = table.facts()
    return _UM_PER_MM / float(facts.latch_per_mm or facts.units_per_mm)


def _in_reach(settings: Settings, axis: str, cause: Cause, farthest_mm: float) -> Cause:
    """Return a cause that switches the rounding off with increments whose 32 bits reach so far.

    They are twice as many as are needed: a motor is beside its load, and both move on. Where the
    drive has as fine ones itself there is nothing to switch off.
    """
    if cause.form != ROUNDING:
        return cause
    table = settings.rig.drive[settings.rig.axis[axis].drive]
    assert isinstance(table, DriveTable), "others have no such switch"
    finest = int(cause.off)
    while finest * 2.0 * farthest_mm >= ENCODER_RANGE * table.lead_mm:
        finest //= 2
    return replace(cause, off=str(max(finest, table.encoder_increments)))


def motion_causes(
    settings: Settings,
    axis: str,
    *,
    is_after_signal: bool,
    gains_speed: bool,
    speed_mm_s: float | None = None,
) -> list[Active]:
    """Return braking, and the run-up where the axis still gains speed at the contact.

    Braking is always looked at: that it has no share is what switching it off shows.
    """
    run_up, braking = (cause for cause in causes() if cause.place == "motion")
    words = braking_words(settings, axis)
    off = without_braking(settings, is_after_signal=is_after_signal, speed_mm_s=speed_mm_s)
    found = [Active(braking, words, words, off)]
    if gains_speed:
        words = run_up_words(settings, axis)
        found.insert(0, Active(run_up, words, words, without_run_up(settings)))
    return found


def _active(case: Case, settings: Settings, axis: str, cause: Cause) -> Active | None:
    if cause.place in ("motion", "line"):
        return _of_line(settings, axis, cause) if cause.place == "line" else None
    if cause.place == "variable":
        value = settings.external.get(cause.key)
        column = f"plc:V.E.{cause.key}"
        words = f"V.E.{cause.key} {value:g}" if value else ""
        return Active(cause, f"{value:g}", words, {column: cause.off}) if value else None
    if cause.place == "fault":
        columns = [name for name in case.inputs if name.startswith("fault:")]
        setting = ", ".join(f"{name} {case.inputs[name]}" for name in columns)
        return Active(cause, setting, setting, dict.fromkeys(columns)) if columns else None
    if cause.place == "axis":
        model = settings.rig.plant[settings.rig.axis[axis].plant].fmu
        if not str(model).removesuffix(".fmu").endswith(cause.model):
            return None
    keys = cause.key.split()
    defaults = cause.default.split()
    values = [
        _value(settings, axis, cause, key, defaults[place] if defaults else None)
        for place, key in enumerate(keys)
    ]
    offs = [_off(settings, text) for text in cause.off.split()]
    if all(value is None or value == off for value, off in zip(values, offs, strict=True)):
        return None
    shown = [
        f"{key} {value} {cause.unit}".rstrip()
        for key, value, off in zip(keys, values, offs, strict=True)
        if value not in (None, off)
    ]
    columns = [_column(settings, axis, cause, key) for key in keys]
    first = next(value for value in values if value is not None)
    return Active(cause, first, ", ".join(shown), dict(zip(columns, offs, strict=True)))


def _of_line(settings: Settings, axis: str, cause: Cause) -> Active | None:
    """Return a cause of the EtherCAT line of an axis; its clocks count where the terminal has one.

    off: a key of the segment for a number, the value itself for a flag.
    """
    segment = settings.rig.axis[axis].segment
    if segment not in ec_segments(settings):
        return None
    table = segment_of(settings, segment)
    if isinstance(getattr(table, cause.key), bool):
        if getattr(table, cause.key) or terminal_on(settings, segment) is None:
            return None
        value, off = "false", cause.off
    else:
        value, off = f"{table.of(cause.key, axis):g}", f"{table.of(cause.off, axis):g}"
    column = f"bus:{segment}.{cause.key}"
    if value == off:
        return None
    return Active(cause, value, f"{cause.key} {value} {cause.unit}".rstrip(), {column: off})


def _off(settings: Settings, text: str) -> str:
    if not text.startswith(ASSUMED):
        return text
    task = settings.rig.plc_task
    return "0" if task is None else f"{getattr(task, text.removeprefix(ASSUMED)):.17g}"


def _place(settings: Settings, axis: str, cause: Cause) -> str:
    """Return the instance, the drive or the axis whose key a cause is."""
    table = settings.rig.axis[axis]
    probe = table.probe_1 or terminal_probe(settings)
    assert probe is not None, "the axis has a probe"
    return {"probe": probe, "axis": table.plant, "drive": table.drive, "set": axis}[cause.place]


def _column(settings: Settings, axis: str, cause: Cause, key: str) -> str:
    if cause.place == "plc":
        return f"plc:{key}"
    kind = {"probe": "plant", "axis": "plant"}.get(cause.place, cause.place)
    name = f"{key}_{cause.unit}" if cause.unit else key
    return f"{kind}:{_place(settings, axis, cause)}.{name}"


def _value(
    settings: Settings, axis: str, cause: Cause, key: str, default: str | None
) -> str | None:
    """Return what a key is set to, in the unit of its cause; None where it is not there."""
    if cause.place == "plc":
        return _of_task(settings.rig.plc_task, key)
    place = _place(settings, axis, cause)
    if cause.place == "set":
        return str(settings.axis[place].integer(key))
    if cause.place == "drive":
        value = getattr(settings.rig.drive[place], key)
        is_exact = isinstance(value, str) or cause.form == ROUNDING
        return str(value) if is_exact else f"{value:g}"
    found = start_value(settings, place, key)
    if found is None:
        return default
    unit = f"_{cause.unit}" if cause.unit else ""
    return f"{found.si() / parse_column(f'plant:p.x{unit}', '1').si():g}"


def _of_task(task: PlcTaskTable | None, key: str) -> str | None:
    *inside, name = key.split(".")
    table = task if not inside or task is None else task.terminal
    value = None if table is None else getattr(table, name)
    return f"{value:.17g}" if isinstance(value, int | float) else value


def probe_of(settings: Settings, axis: str) -> str:
    """Return the plant instance of the probe that measures for an axis."""
    return settings.rig.axis[axis].probe_1 or terminal_probe(settings) or ""
