"""What a row of a plan (or `--set`) changes on a rig before it is built.

`Settings` applies assignments to the tables of a rig; it keeps where each one came from, so that
a wrong value is reported with the place where it was written.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import update_wrapper
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, TypeVar

from pydantic import ValidationError

from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.rig.plc.axis_words import ProbingWrite
from axisrig.bench.rig.plc.words import VARIABLE, Rule, needs_variables, read_rules
from axisrig.bench.rig.reading.families import read_segment
from axisrig.bench.rig.reading.faults import Fault, needs_heartbeats, read_faults
from axisrig.bench.rig.reading.file import RigFile
from axisrig.bench.rig.reading.influence import assumed_notes, influence_notes
from axisrig.bench.rig.reading.language import language_notes
from axisrig.bench.rig.reading.law import DistanceTable
from axisrig.bench.rig.reading.lists import (
    OFFSET_LISTS,
    inert_notes,
    offset_notes,
    read_lists,
    read_offsets,
    relation_notes,
    stop_notes,
    take_over,
)
from axisrig.bench.rig.reading.plc_task import PLAIN_TASK_KEYS, PlcTaskTable
from axisrig.bench.rig.reading.tables import SegmentKeys, Table, in_words
from axisrig.kernel.errors import Alarm, UserError, near_files, nearest
from axisrig.kernel.kinematics import KinematicData
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.coordinates.circle import CircleLimits
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.parameters import Origin, ParameterSet
from axisrig.kernel.time.clock import MS, S, TimeNs

PER_MILLE = 1000
SIMULATED_LIMIT_NS = 600 * S

EVERY_ONE = "all"
"""Means all segments in a `bus:` column, for all drives in a `drive:` column."""

FORCED = f"bus:{EVERY_ONE}.overload=run"
"""The assignment that `--force` means."""

AS_CANOPEN = f"drive:{EVERY_ONE}.as_canopen=true"
"""The assignment that `--as-canopen` means."""

Located = Callable[[UserError, Assignment], UserError]
"""Turns an error of an assignment into one that names the place it was written at."""

Assigned = tuple[Assignment, Located]


def as_written(error: UserError, assignment: Assignment) -> UserError:
    """Name the assignment itself: the place of a `--set` on the command line."""
    return UserError(
        f"--set {assignment.column}={assignment.value}: {error.message}",
        value=error.value,
        allowed=error.allowed,
        hint=error.hint,
    )


@dataclass(frozen=True)
class Operator:
    """Who starts a program again that M0 has stopped, and gives one up that does not end.

    start_after_ns: how long after the stop; None when nobody does. optional_stop: whether M1
    stops as well. limit_ns: simulated time that a program may take. after_end_ns: for how long the
    run goes on when the program has ended.
    """

    start_after_ns: TimeNs | None = None
    optional_stop: bool = False
    limit_ns: TimeNs = SIMULATED_LIMIT_NS
    after_end_ns: TimeNs = 0


Bare = dict[str, tuple[str, Sequence[str]]]
"""Columns without a unit -> the unit in which they count, and columns that name one."""


@dataclass
class Settings:
    """A rig with the assignments of one run applied.

    axis, channel: parameter sets. start: plant instance -> assignments of its start values.
    external: V.E variables by the name after the prefix. operator: how stops go on. plc: what
    else the PLC side does.
    faults: what goes wrong.
    has_kernel: false where only the drives of the rig run, for the master of somebody else.
    written: the rig as its files have it. assigned: what was applied to it, in its order.
    offsets: values of the lists of zero offsets and tools.
    warnings: what the control corrects at its start. notes: settings of lists that do not act yet.
    bare: columns of start values that name no unit although there are several -> the unit that
    their values got, and the names of columns that would name one. bare_in_rig: the same of start
    values of the rig.
    is_settled: nothing is changed any more. is_checked: a machine was built of them, too. known:
    what `once` has found out of settled ones. A changed copy (`replace`) begins without all three.
    """

    rig: RigFile
    written: RigFile
    files: list[Path]
    channel: ParameterSet
    axis: dict[str, ParameterSet]
    segment: dict[str, SegmentKeys]
    start: dict[str, list[tuple[Assignment, Located]]] = field(default_factory=dict)
    external: dict[str, float] = field(default_factory=dict)
    operator: Operator = Operator()
    plc: list[Rule] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    has_kernel: bool = True
    assigned: Sequence[Assigned] = ()
    warnings: list[Alarm] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    offsets: Lists = field(default_factory=Lists)
    bare: Bare = field(default_factory=dict)
    bare_in_rig: Bare = field(default_factory=dict)
    is_settled: bool = field(default=False, init=False, compare=False)
    is_checked: bool = field(default=False, init=False)
    known: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def offset_tables(self) -> OffsetTables:
        """Zero offsets and tools as a program finds them."""
        return self.offsets.tables(
            rotary=[name for name, parameters in self.axis.items() if parameters.is_rotary],
            ball_radius_counts=not self.channel.flag("meas_pcs_value_no_probe_radius"),
            circle=_circle_limits(self),
            kinematics=_kinematics(self),
            cycle_changes_modal=self.channel.flag("cycle_changes_modal"),
        )

    def apply(self, assignment: Assignment, located: Located) -> None:
        """Apply one assignment. Raises UserError, with its place, for one that does not fit."""
        try:
            {
                "set": self._set,
                "plant": self._plant,
                "drive": self._drive,
                "bus": self._bus,
                "distance": self._distance,
                "plc": self._plc,
                "fault": self._fault,
            }[assignment.kind](assignment, located)
        except UserError as error:
            raise located(error, assignment) from error

    def _set(self, item: Assignment, _located: Located) -> None:
        known = {"channel": self.channel, **self.axis}
        if item.target in OFFSET_LISTS and item.target not in known:
            name = OFFSET_LISTS[item.target]
            self.offsets.set(name, item.name, item.value, Origin(item.column))
            return
        if item.target not in known:
            allowed = [*known, *OFFSET_LISTS]
            raise UserError("the rig has no such axis", value=item.target, allowed=allowed)
        known[item.target].set(item.name, item.value, item.column)

    def _plant(self, item: Assignment, located: Located) -> None:
        if item.target not in self.rig.plant:
            raise UserError("the rig has no such plant", value=item.target, allowed=self.rig.plant)
        self.start.setdefault(item.target, []).append((item, located))

    def _drive(self, item: Assignment, _located: Located) -> None:
        for name in _meant(item, "drive", self.rig.drive):
            self._drive_key(name, item)

    def _drive_key(self, name: str, item: Assignment) -> None:
        if item.name == "family":
            raise UserError("a run does not change the family of a drive", value=item.value)
        drives = self.rig.drive
        if item.names_file and not Path(item.value).is_file():
            raise UserError(
                f"{item.name} names no file", value=item.value, hint=near_files(Path(), item.value)
            )
        value = drives[name].value_of(item.name, item.value)
        try:
            table = drives[name].changed(item.name, value)
        except ValidationError as error:
            raise UserError(
                f"{item.name}: {error.errors()[0]['msg'].lower()}", value=item.value
            ) from error
        self.rig = self.rig.model_copy(update={"drive": {**drives, name: table}})

    def _bus(self, item: Assignment, _located: Located) -> None:
        for name in _meant(item, "segment", self.segment):
            self._bus_key(name, item)

    def _bus_key(self, segment: str, item: Assignment) -> None:
        if item.name == "carrier":
            raise UserError("a run does not change what carries a segment", value=item.value)
        values = self.segment[segment].model_dump()
        values[item.name] = int(item.value[:12]) if item.value.isdecimal() else item.value
        try:
            self.segment[segment] = read_segment(values)
        except ValidationError as error:
            raise UserError(
                f"{item.name}: {error.errors()[0]['msg'].lower()}", value=item.value
            ) from error

    def _distance(self, item: Assignment, _located: Located) -> None:
        fields = DistanceTable.model_fields
        if item.name not in fields:
            raise UserError(
                "[distance] has no such key",
                value=item.name,
                allowed=nearest(item.name, fields) or fields,
            )
        values = self.rig.distance.model_dump() | {item.name: item.value}
        try:
            table = DistanceTable.model_validate(values)
        except ValidationError as error:
            message = in_words(error.errors()[0]["type"], error.errors()[0]["msg"])
            raise UserError(f"{item.name}: {message}", value=item.value) from error
        self.rig = self.rig.model_copy(update={"distance": table})

    def _plc(self, item: Assignment, _located: Located) -> None:
        if item.name == "start_ms":
            if not 0.0 <= item.si() <= 1e9:
                raise UserError("no time", value=item.value, allowed="0 .. 1e9 ms")
            self.operator = replace(self.operator, start_after_ns=round(item.si() * MS))
            return
        if item.name == "after_end_ms":
            if not 0.0 <= item.si() <= 1e7:
                raise UserError("no time", value=item.value, allowed="0 .. 1e7 ms")
            self.operator = replace(self.operator, after_end_ns=round(item.si() * MS))
            return
        if item.name == "limit_s":
            if not 0.001 <= item.si() <= 1e7:
                raise UserError("no time", value=item.value, allowed="0.001 .. 1e7 s")
            self.operator = replace(self.operator, limit_ns=round(item.si() * S))
            return
        if item.name == "optional_stop":
            if item.value not in ("0", "1"):
                raise UserError("optional_stop is on or off", value=item.value, allowed="0, 1")
            self.operator = replace(self.operator, optional_stop=item.value == "1")
            return
        if item.name in PLAIN_TASK_KEYS:
            self._plc_task(item)
            return
        if item.name in self.rig.plc:
            raise UserError(
                "the PLC side of this rig reads that variable from a sensor ([plc])",
                value=item.name,
            )
        first, rules = read_rules(item, list(self.rig.axis))
        if self.rig.plc_task and any(isinstance(rule.action, ProbingWrite) for rule in rules):
            raise UserError("the PLC task of this rig gives the probing signal", value=item.name)
        if first is not None:
            self.external[item.name.removeprefix(VARIABLE)] = first
        # The last one counts: --set acts on top of a table
        self.plc = [rule for rule in self.plc if rule.column != item.column] + rules

    def _plc_task(self, item: Assignment) -> None:
        """Change a key of `[plc]` or `[plc.terminal]`."""
        task = self.rig.plc_task
        if task is None:
            raise UserError(
                "the rig has no PLC task", value=item.name, hint="period_us and program in [plc]"
            )
        values = task.model_dump()
        *_, key = item.name.split(".")
        inside = values if key == item.name else values["terminal"]
        if inside is None:
            raise UserError("the PLC of this rig has no terminal", value=item.name)
        inside[key] = _plain(item.value)
        try:
            changed = PlcTaskTable.model_validate(values)
        except ValidationError as error:
            message = error.errors()[0]["msg"].lower()
            raise UserError(f"{item.name}: {message}", value=item.value) from error
        self.rig = self.rig.model_copy(update={"plc_task": changed})

    def _fault(self, item: Assignment, _located: Located) -> None:
        self.faults += read_faults(item.name, item.value, self.rig)


def _plain(text: str) -> int | float | str:
    """Return a value as TOML has it: a whole number, a number, a word."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _meant(item: Assignment, what: str, known: Mapping[str, Table]) -> list[str]:
    """Return the names that an assignment is about; one that is called `all` is just itself.

    `all` means those that have the key: drives and segments may be of several kinds. Raises
    UserError where none has it.
    """
    if item.target not in (*known, EVERY_ONE):
        allowed = [*known, EVERY_ONE]
        raise UserError(f"the rig has no such {what}", value=item.target, allowed=allowed)
    asked = [item.target] if item.target in known else list(known)
    keys = {name: type(known[name]).model_fields for name in asked}
    meant = [name for name in asked if item.name in keys[name]]
    if not meant:
        allowed = list(dict.fromkeys(key for name in asked for key in keys[name]))
        raise UserError(
            f"a {what} has no such key",
            value=item.name,
            allowed=nearest(item.name, allowed) or allowed,
        )
    return meant


def read_settings(rig: RigFile, files: list[Path], assignments: Sequence[Assigned]) -> Settings:
    """Read the parameter lists of a rig and apply assignments in their order."""
    channel, axes = read_lists(rig, files)
    settings = Settings(
        rig=rig,
        written=rig,
        assigned=tuple(assignments),
        files=files,
        channel=channel,
        axis=axes,
        segment=dict(rig.segment),
        offsets=read_offsets(rig, files),
        external={name.removeprefix(VARIABLE): 0.0 for name in rig.plc},
    )
    mistakes = Mistakes()
    for assignment, located in assignments:
        with mistakes.kept():
            settings.apply(assignment, located)
    mistakes.refuse(files[0])
    try:
        settings.warnings = take_over(channel, axes)
        settings.notes = inert_notes(rig, channel, axes)
        settings.notes += assumed_notes(rig)
        settings.notes += language_notes(rig, files)
        settings.notes += influence_notes(rig, files, channel, axes)
        settings.notes += relation_notes(axes)
        settings.notes += stop_notes(axes)
        settings.notes += offset_notes(settings.offsets, tuple(axes))
    except UserError as error:
        for assignment, located in assignments:
            if assignment.column == error.file:
                raise located(error, assignment) from error
        raise
    for assignment, located in assignments:  # when drives and variables are known
        try:
            if assignment.kind == "fault":
                faults = read_faults(assignment.name, assignment.value, settings.rig)
                needs_heartbeats(faults, settings.rig)
            if assignment.kind == "plc":
                needs_variables(settings.plc, assignment.column, settings.external)
        except UserError as error:
            raise located(error, assignment) from error
    return settings


Given = ParamSpec("Given")
Found = TypeVar("Found")


def once(
    function: Callable[Concatenate[Settings, Given], Found],
) -> Callable[Concatenate[Settings, Given], Found]:
    """Let a function of settings work only once for each that are settled, and for its arguments.

    Its result is shared: nobody may change it. Other settings may change, so it works anew.
    """

    def call(settings: Settings, /, *args: Given.args, **named: Given.kwargs) -> Found:
        if not settings.is_settled:
            return function(settings, *args, **named)
        key = (function, args, tuple(named.items()))
        if key not in settings.known:
            settings.known[key] = function(settings, *args, **named)
        found: Found = settings.known[key]
        return found

    update_wrapper(call, function)
    return call


@once
def _circle_limits(settings: Settings) -> CircleLimits:
    channel = settings.channel
    return CircleLimits(
        channel.mm("mittelpkt_diff"),
        channel.integer("mittelpkt_faktor") / PER_MILLE,
        channel.mm("max_radius_diff_circle"),
        channel.integer("max_proz_radius_diff_circle") / PER_MILLE,
    )


@once
def _kinematics(settings: Settings) -> KinematicData:
    return KinematicData.read(settings.channel)
