"""The PLC side while a program runs: notices the moments of its rules and acts on them.

It has a turn in every NC cycle. A time comes in the first cycle at or after it; what the program
did in a cycle is noticed in the next one, and a time after it counts from that cycle. Values for
drives go over SDO beside the cycle, in turn with those of #DRIVE.
"""

import heapq
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from axisrig.bench.machine.plc.control_units import PlcUnits
from axisrig.bench.machine.plc.probing_columns import ProbingColumns
from axisrig.bench.rig.plc.axis_words import (
    AxisFeedhold,
    ObjectChange,
    ProbingWrite,
    SetCourse,
    UnitWrite,
)
from axisrig.bench.rig.plc.channel_words import Feedhold, ProgramStart, Reset
from axisrig.bench.rig.plc.courses import Courses
from axisrig.bench.rig.plc.override import PERMILLE_PER_PCT, OverrideCourse
from axisrig.bench.rig.plc.words import VARIABLE, ObjectWrite, Rule, VariableWrite
from axisrig.kernel.channel import Channel
from axisrig.kernel.drives.canopen.drive_functions import DriveAccess
from axisrig.kernel.drives.cia402.objects import SdoError, object_name
from axisrig.kernel.drives.functions import type_range
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS, Clock, TimeNs

_BEHIND_PROGRAMS = ("reset", "program_end")


class _Happening(NamedTuple):
    """A moment that has come; function: the PLC side may have to acknowledge it."""

    time_ns: TimeNs
    word: str
    value: float | None = None
    is_function: bool = False


class PlcSide:
    """Carries out the rules of a run on one channel; accesses: the ways to its drives.

    A function that a rule waits for is acknowledged when everything that it causes is done,
    a value for a drive when the drive has taken it; no function waits for a reset or a start.
    With one of these, or a moment after one, among the rules, the run goes on until nothing is
    left to do. program: gives the commands of the program of the run, or of a file beside it.
    Raises UserError for an object that an RPDO carries: the next telegram would overwrite it.
    """

    def __init__(
        self,
        channel: Channel,
        accesses: Mapping[str, DriveAccess],
        rules: Sequence[Rule],
        clock: Clock,
        period_ns: TimeNs,
        program: Callable[[str | None], Iterator[canon.Command]],
    ) -> None:
        self._program = program
        self._channel, self._plc, self._clock = channel, channel.plc, clock
        self._accesses, self._rules, self._period_ns = accesses, tuple(rules), period_ns
        self._due: list[tuple[TimeNs, int, Callable[[], None]]] = []
        self._order = 0  # of what is due at one instant
        self._come: Counter[int] = Counter()  # moments of each rule
        self._has_acted: set[int] = set()
        self._seen_events = self._runs_begun = 0
        self._runs_ended: set[int] = set()
        self._is_started = self._was_moving = False
        self._holds: Counter[str | None] = Counter()  # of each axis, None = of the path
        self._held_by: Counter[int] = Counter()  # by rules that last until a moment
        self._courses = Courses(clock, period_ns, self._at)
        self._units = PlcUnits(channel, self._courses)
        self._ends_seen = self._resets_seen = 0
        self._open_writes = 0
        self._unacknowledged = 0  # actions that the last function waits for
        for rule in rules:
            self._refuse_write(rule)
            self._refuse_object(rule)
        written = [r.action for r in rules if isinstance(r.action, ProbingWrite)]
        self._probing = ProbingColumns(channel, clock, period_ns, written)
        if rules:
            words = {rule.moment.word for rule in rules if _is_awaited(rule)}
            self._plc.join(
                PlcParticipant(
                    self.take_turn,
                    acknowledged_later=frozenset(w for w in words if w[1:].isdecimal()),
                    outlives_program=any(_goes_beyond_program(rule) for rule in rules),
                    is_idle=self._is_idle,
                    task=self._probing.task,
                )
            )

    def _is_idle(self) -> bool:
        """Whether nothing is left to do, as nothing will come while no program runs."""
        channel = self._channel
        seen = self._ends_seen, self._resets_seen
        if seen != (len(channel.program_ends_ns), len(channel.resets_ns)):
            return False
        return not (self._due or self._open_writes or self._units.is_waiting)

    def _refuse_write(self, rule: Rule) -> None:
        write = rule.action
        if not isinstance(write, ObjectWrite):
            return
        if write.axis not in self._accesses:
            raise UserError(
                f"{rule.column}: the drive of axis {write.axis} has no objects",
                value=rule.text,
                hint="drives of CiA 402 have; leave the column out",
            )
        try:
            self._accesses[write.axis].link.get_object(write.object.index, 0)
        except KeyError:
            return
        raise UserError(
            f"{rule.column}: an RPDO of axis {write.axis} carries {write.object.name},"
            " which would overwrite it with the next cycle",
            value=rule.text,
            hint="write it with #DRIVE, or take it out of the pdo_map of the drive",
        )

    def _refuse_object(self, rule: Rule) -> None:
        change = rule.action
        if isinstance(change, ObjectChange) and change.axis not in self._channel.distance.axes:
            raise UserError(
                f"{rule.column}: axis {change.axis} has no distance control",
                value=rule.text,
                hint="its list sets lr_param.distance_control_on (P-AXIS-00328) to 1",
            )

    def not_come(self) -> list[str]:
        """Say which rules have not acted, as their moment has not come."""
        return [
            f"{rule.column}: {rule.text} has not come"
            for number, rule in enumerate(self._rules)
            if number not in self._has_acted
        ]

    @property
    def writes_variables(self) -> bool:
        """Whether a V.E. variable changes by itself, so that a program may wait for it."""
        return any(isinstance(rule.action, VariableWrite) for rule in self._rules)

    def take_turn(self) -> None:
        """Do the work of one cycle."""
        self._probing.begin_turn()
        for happening in self._happenings():
            for number, rule in enumerate(self._rules):
                if rule.moment.fits(happening.word, happening.value):
                    self._come[number] += 1
                    if rule.nth in (None, self._come[number]):
                        is_awaited = happening.is_function and _is_awaited(rule)
                        self._unacknowledged += is_awaited
                        action = partial(self._act, number, rule, is_awaited)
                        self._at(happening.time_ns + rule.moment.offset_ns, action)
                until = rule.until
                if until is not None and until.fits(happening.word, happening.value):
                    self._at(happening.time_ns + until.offset_ns, partial(self._let_go, number))
            if happening.is_function and not self._unacknowledged:
                self._plc.acknowledge()
        while self._due and self._due[0][0] <= self._clock.now_ns:
            heapq.heappop(self._due)[2]()
        self._plc.feedhold = self._holds[None] > 0
        for axis, unit in self._plc.axis.items():
            unit.feedhold = self._holds[axis] > 0
        self._units.hand_over()

    def _at(self, time_ns: TimeNs, action: Callable[[], None]) -> None:
        self._order += 1
        heapq.heappush(self._due, (time_ns, self._order, action))

    # Moments

    def _happenings(self) -> Iterator[_Happening]:
        now_ns, before_ns = self._clock.now_ns, self._clock.now_ns - self._period_ns
        if not self._is_started:
            self._is_started = True
            yield _Happening(now_ns, "start")
        events = self._plc.events
        for event in events[self._seen_events :]:
            command = event.command
            if isinstance(command, canon.TechnologyFunction):
                is_mine = command.word in self._plc.acknowledged_later
                yield _Happening(event.time_ns, command.word, is_function=is_mine)
            elif isinstance(command, canon.ExternalWrite):
                word = f"{VARIABLE}{command.name}".upper()
                yield _Happening(event.time_ns, word, command.value)
        self._seen_events = len(events)
        yield from self._runs()
        yield from self._ends()
        is_moving = self._channel.path.is_moving
        if is_moving is not self._was_moving:
            self._was_moving = is_moving
            yield _Happening(before_ns, "motion" if is_moving else "standing")

    def _runs(self) -> Iterator[_Happening]:
        records = self._channel.records
        for number, record in enumerate(records):
            if number >= self._runs_begun:
                self._runs_begun += 1
                yield _Happening(record.begin_ns, "run")
            if record.end_ns is not None and number not in self._runs_ended:
                self._runs_ended.add(number)
                yield _Happening(record.end_ns, "run_end")

    def _ends(self) -> Iterator[_Happening]:
        channel = self._channel
        for time_ns in channel.program_ends_ns[self._ends_seen :]:
            yield _Happening(time_ns, "program_end")
        for time_ns in channel.resets_ns[self._resets_seen :]:
            yield _Happening(time_ns, "reset")
        self._ends_seen = len(channel.program_ends_ns)
        self._resets_seen = len(channel.resets_ns)

    # Actions

    def _act(self, number: int, rule: Rule, is_awaited: bool) -> None:
        self._has_acted.add(number)
        match rule.action:
            case ObjectWrite() as write:
                self._write(write, rule, is_awaited)
                return
            case VariableWrite(name=name, value=value):
                self._plc.values[name] = value
                self._plc.note(f"V.E.{name} = {value:.15g} from the PLC", rule.column)
            case Feedhold(for_ns=for_ns):
                self._hold(number, rule, None, for_ns)
            case AxisFeedhold(axis=axis, for_ns=for_ns):
                self._hold(number, rule, axis, for_ns)
            case OverrideCourse() as override:
                self._lead_override(override, rule, is_awaited)
                return
            case Reset():
                self._plc.wants_reset = True
                self._plc.note("reset from the PLC", rule.column)
            case ProgramStart(file=file):
                self._plc.program = self._program(file)
                self._plc.note(f"start of {file or 'the program'} from the PLC", rule.column)
            case UnitWrite() as command:
                self._plc.note(f"{command.axis}.dist_ctrl = {_command(rule)}", rule.column)
                self._units.command(command)
            case SetCourse() as course:
                self._lead(course, rule, is_awaited)
                return
            case ProbingWrite() as write:
                self._plc.note(self._probing.write(write), rule.column)
            case ObjectChange(axis=axis, name=name, value=value):
                self._channel.distance.write_object(axis, name, value)
                self._plc.note(f"{axis} {name} = {value} from the PLC", rule.column)
        self._done(is_awaited)

    def _lead(self, course: SetCourse, rule: Rule, is_awaited: bool) -> None:
        words = f"{course.axis}.{course.value} = {course.to_mm:.15g}"
        self._plc.note(f"{words}{_over(course.over_ns)} from the PLC", rule.column)
        self._units.follow(course, lambda: self._done(is_awaited))

    def _lead_override(self, course: OverrideCourse, rule: Rule, is_awaited: bool) -> None:
        """Lead the override of an axis or of the path, in whole steps of 0.1 %."""
        unit = self._plc if course.axis is None else self._plc.axis[course.axis]

        def put(permille: float) -> None:
            unit.override_permille = round(permille)

        begin, done = unit.override_permille, partial(self._done, is_awaited)
        words = "override" if course.axis is None else f"{course.axis}.override"
        words += f" = {course.permille / PERMILLE_PER_PCT:g} %{_over(course.over_ns)}"
        self._plc.note(f"{words} from the PLC", rule.column)
        key = "override", course.axis
        self._courses.lead(key, begin, course.permille, course.over_ns, put, done)

    def _hold(self, number: int, rule: Rule, axis: str | None, for_ns: TimeNs | None) -> None:
        """Hold the path or an axis; where two overlap it is held until both are over."""
        self._holds[axis] += 1
        if self._holds[axis] == 1:
            self._plc.note(f"{_feedhold(axis)} on", rule.column)
        if for_ns is None:
            self._held_by[number] += 1
        else:
            self._at(self._clock.now_ns + for_ns, partial(self._release, rule, axis))

    def _let_go(self, number: int) -> None:
        """End the feedholds of a rule that last until the moment that has come."""
        rule = self._rules[number]
        axis = rule.action.axis if isinstance(rule.action, AxisFeedhold) else None
        for _ in range(self._held_by.pop(number, 0)):
            self._release(rule, axis)

    def _release(self, rule: Rule, axis: str | None) -> None:
        self._holds[axis] -= 1
        if not self._holds[axis]:
            self._plc.note(f"{_feedhold(axis)} off", rule.column)

    def _write(self, write: ObjectWrite, rule: Rule, is_awaited: bool) -> None:
        target, words = write.object, f"{write.axis}.{write.object.name} = {write.value}"
        _, high = type_range(target.type)
        self._plc.note(f"{words} from the PLC", rule.column)

        self._open_writes += 1

        def answered(answer: bytes | SdoError) -> None:
            self._open_writes -= 1
            if isinstance(answer, SdoError):
                alarm = Alarm(
                    900270,
                    axis=write.axis,
                    column=rule.column,
                    object=object_name(target.index, 0),
                    value=write.value,
                    answer=str(answer),
                )
                self._plc.report(alarm)
            else:
                self._plc.note(f"{words}: the drive has taken it", rule.column)
            self._done(is_awaited)

        data = write.value.to_bytes(high.bit_length() // 8, "little")
        self._accesses[write.axis].sdo.write(target.index, 0, data, answered)

    def _done(self, is_awaited: bool) -> None:
        if is_awaited:
            self._unacknowledged -= 1
            if not self._unacknowledged:
                self._plc.acknowledge()


def _is_awaited(rule: Rule) -> bool:
    """Whether a function waits for the action: no program waits for its own end, or the next."""
    return not isinstance(rule.action, Reset | ProgramStart)


def _goes_beyond_program(rule: Rule) -> bool:
    moments = [rule.moment, *([rule.until] if rule.until else [])]
    is_behind = any(moment.word in _BEHIND_PROGRAMS for moment in moments)
    return is_behind or isinstance(rule.action, Reset | ProgramStart)


def _over(over_ns: TimeNs) -> str:
    return f" over {over_ns / MS:g} ms" if over_ns else ""


def _feedhold(axis: str | None) -> str:
    return "feedhold" if axis is None else f"feedhold of {axis}"


def _command(rule: Rule) -> str:
    """Return a command as it is written, without its moment."""
    words = [word for word in rule.text.split() if not word.startswith(("at=", "nth="))]
    return f"{' '.join(words)} from the PLC"
