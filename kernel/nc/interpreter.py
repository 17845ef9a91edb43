"""Runs a checked program: blocks in, commands of `canon` out."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Protocol

from kernel.errors import Alarm, UserError, nearest
from kernel.nc import canon, message
from kernel.nc.builder import TAKES_AXES
from kernel.nc.canon import Block
from kernel.nc.commands import is_measuring_type
from kernel.nc.coordinates import Coordinates, Frame, Measured
from kernel.nc.expressions import NoValue, evaluate
from kernel.nc.measuring_types import measuring_types
from kernel.nc.syntax import (
    DriveRead,
    DriveWait,
    DriveWrite,
    Expression,
    MeasuringMode,
    MessageOut,
    Program,
    ProgramBlock,
    Statement,
    SystemOff,
    SystemOn,
    Text,
    Words,
)

# What the variables of an axis read: positions always have a value, results only after a run.
_POSITIONS: Mapping[str, Callable[[Coordinates, str], float]] = {
    "V.A.PROG": Coordinates.programmed_mm,
    "V.A.ABS": Coordinates.absolute_mm,
    "V.A.MEIN": Coordinates.measurement_offset_mm,
}
_RESULTS: Mapping[str, Callable[[Measured], float]] = {
    "V.A.MESS": lambda measured: measured.mess_mm,
    "V.A.MEAS.ACS.VALUE": lambda measured: measured.acs_mm,
    "V.A.MEAS.PCS.VALUE": lambda measured: measured.pcs_mm,
    "V.A.MOFFS": lambda measured: measured.offset_mm,
}


class MachineView(Protocol):
    """What the interpreter reads from the machine, at the start and after each `Wait`."""

    def position_acs_mm(self, axis: str) -> float:
        """Give the axis position at which the interpolation stands."""
        ...

    def measured_acs_mm(self, axis: str) -> float | None:
        """Give the axis position latched in the last run; None without a valid value."""
        ...

    def measurement_ok(self, axis: str) -> bool:
        """Tell whether the signal of the last run came before the target."""
        ...

    def drive_value(self, axis: str, key: str) -> float:
        """Give what the last `DriveRead` of this axis and function brought."""
        ...


class Interpreter:
    """Decodes a program for one channel.

    axes: those the program was checked for, main axes first. external: values of `V.E.<name>` by
    name, read whenever a block uses one; upper and lower case do not differ.
    default_measuring_type: P-CHAN-00057.
    Raises UserError for a `V.E.` variable that `external` does not have.
    """

    def __init__(
        self,
        program: Program,
        axes: Sequence[str],
        machine: MachineView,
        *,
        external: Mapping[str, float],
        default_measuring_type: int = 1,
    ) -> None:
        assert tuple(axes) == program.axes, "the program was checked for other axes"
        self._program = program
        self._machine = machine
        self._external = external
        self._external_names = {name.upper(): name for name in external}
        self._check_external()
        self._default_type = default_measuring_type
        self._type = default_measuring_type
        # G1 without F is an alarm; starting in rapid would move before anyone said so.
        self._motion = "G1"
        self._absolute = True
        self._feed_mm_min: float | None = None
        self._coordinates = Coordinates(program.axes, dict.fromkeys(program.axes, 0.0))
        self._measured: dict[str, Measured] = {}
        self._own: dict[str, float] = {}
        self._signalled = dict.fromkeys(program.axes, False)

    def commands(self) -> Iterator[canon.Command]:
        """Yield the commands of the program, `EndOfProgram` last.

        After a `Wait` the generator must be resumed only when everything before is executed.
        Raises Alarm with the file, line and block number as its place.
        """
        # The machine knows where its axes stand only when the program begins
        axes = self._program.axes
        self._coordinates = Coordinates(
            axes, {axis: self._machine.position_acs_mm(axis) for axis in axes}
        )
        block = Block(1, None, "")
        for part in self._program.blocks:
            block = part.block
            yield from self._decode(part)
            if isinstance(part.statement, Words) and part.statement.ends_program:
                break
        yield canon.EndOfProgram(block)

    def _decode(self, part: ProgramBlock) -> Iterator[canon.Command]:
        statement: Statement | None = part.statement
        match statement:
            case Words():
                yield from self._decode_words(part.block, statement)
            case MeasuringMode():
                self._choose_type(part.block, statement)
            case SystemOn(components):
                values = [self._value(part.block, component) for component in components]
                self._coordinates.switch_on(Frame.of(values))
            case SystemOff(all_systems):
                self._switch_off(part.block, all_systems)
            case MessageOut():
                yield from self._put_out(part.block, statement)
            case DriveWrite(axis, key, value, waits):
                number = self._value(part.block, value)
                yield canon.DriveWrite(part.block, axis, key, number, waits)
            case DriveWait(axis):
                yield canon.DriveWait(part.block, axis)
            case DriveRead(axis, key, variable):
                yield canon.DriveRead(part.block, axis, key)
                yield canon.Wait(part.block)
                self._own[variable] = self._machine.drive_value(axis, key)

    def _decode_words(self, block: Block, words: Words) -> Iterator[canon.Command]:
        if "G90" in words.g or "G91" in words.g:
            self._absolute = "G90" in words.g
        if "G0" in words.g or "G1" in words.g:
            self._motion = "G0" if "G0" in words.g else "G1"
        if words.feed is not None:
            self._feed_mm_min = self._value(block, words.feed)
        values = {axis: self._value(block, value) for axis, value in words.axes}
        match next((g for g in words.g if g in TAKES_AXES), None):
            case "G92":
                for axis, shift_mm in values.items():
                    self._coordinates.shift_reference(axis, shift_mm, added=not self._absolute)
            case "G100":
                yield from self._measure(block, values)
            case "G101":
                self._include_offset(block, values)
            case "G102":
                self._drop_offset(block, tuple(values) or self._program.axes)
            case _:
                yield from self._move(block, values)

    def _move(self, block: Block, values: Mapping[str, float]) -> Iterator[canon.Command]:
        if not values:
            return
        rapid = self._motion == "G0"
        feed_mm_min = None if rapid else self._feed(block, "G1")
        target_mm = self._coordinates.aim(values, absolute=self._absolute)
        if target_mm:
            yield canon.LinearMove(block, target_mm, rapid, feed_mm_min)

    def _measure(self, block: Block, values: Mapping[str, float]) -> Iterator[canon.Command]:
        """G100, type 1. Source: FCT-C4 sections 3 and 4."""
        kind = measuring_types()[self._type]
        if kind.command != "G100":
            raise self._alarm(20138, block, type=self._type)
        if kind.axes_max is not None and len(values) > kind.axes_max:
            raise self._alarm(
                50061, block, programmed=len(values), maximum=kind.axes_max, type=self._type
            )
        if not kind.acts:
            raise self._alarm(900102, block, type=self._type)
        feed_mm_min = self._feed(block, "G100")
        target_mm = self._coordinates.aim(values, absolute=self._absolute)
        if not target_mm:
            raise self._alarm(900103, block, axes=" ".join(values))
        involved = set(target_mm)
        if self._coordinates.transformed:
            involved |= set(self._coordinates.main_axes)
        measuring = tuple(axis for axis in self._program.axes if axis in involved)
        yield canon.MeasuringRun(
            block, target_mm, tuple(values), measuring, feed_mm_min, self._type
        )
        yield canon.Wait(block)
        self._take_results(measuring, tuple(values), moved=tuple(target_mm))

    def _take_results(
        self, measuring: Sequence[str], programmed: Sequence[str], moved: Sequence[str]
    ) -> None:
        """Keep what the run gave, as seen in the coordinate system in which it took place.

        Axes that are neither measuring nor programmed keep the values of an earlier run.
        Source: FCT-C4 section 5, notice on several runs.
        """
        self._coordinates.stand_at({axis: self._machine.position_acs_mm(axis) for axis in moved})
        latched_mm = {}
        for axis in dict.fromkeys((*measuring, *programmed)):
            self._measured.pop(axis, None)
            self._signalled[axis] = axis in measuring and self._machine.measurement_ok(axis)
            value_mm = self._machine.measured_acs_mm(axis) if self._signalled[axis] else None
            if value_mm is not None:
                latched_mm[axis] = value_mm
        self._measured.update(self._coordinates.measured(latched_mm))

    def _include_offset(self, block: Block, factors: Mapping[str, float]) -> None:
        self._require_offset_type(block, "G101")
        shifts_mm = {
            axis: factor * self._measured_value(block, axis, "G101").offset_mm
            for axis, factor in factors.items()
        }
        for axis, shift_mm in shifts_mm.items():
            self._coordinates.include_measurement(axis, shift_mm)

    def _drop_offset(self, block: Block, axes: Sequence[str]) -> None:
        self._require_offset_type(block, "G102")
        for axis in axes:
            self._coordinates.include_measurement(axis, 0.0)

    def _choose_type(self, block: Block, mode: MeasuringMode) -> None:
        if mode.measuring_type is None:
            self._type = self._default_type
            return
        value = self._value(block, mode.measuring_type)
        if not is_measuring_type(value):
            raise self._alarm(900104, block, value=f"{value:g}")
        self._type = int(value)

    def _switch_off(self, block: Block, all_systems: bool) -> None:
        if all_systems:
            self._coordinates.switch_off_all()
        elif self._coordinates.transformed:
            self._coordinates.switch_off()
        else:
            raise self._alarm(900108, block)

    def _put_out(self, block: Block, statement: MessageOut) -> Iterator[canon.Command]:
        if statement.synchronous:
            yield canon.Wait(block)
        values = [
            argument if isinstance(argument, Text) else self._value(block, argument)
            for argument in statement.arguments
        ]
        try:
            text = message.formatted(statement.pieces, values)
        except message.NotWhole as fault:
            raise self._alarm(
                900107, block, value=f"{fault.value:g}", format=fault.element
            ) from None
        numbers = tuple(value for value in values if not isinstance(value, Text))
        yield canon.Message(block, text, statement.synchronous, numbers)

    # ---- values

    def _value(self, block: Block, expression: Expression) -> float:
        try:
            return evaluate(expression, lambda name: self._read(block, name))
        except NoValue as fault:
            raise self._alarm(900105, block, reason=str(fault)) from None

    def _read(self, block: Block, name: str) -> float:
        """Give the value of a variable; the table of variables has checked its name."""
        if name == "V.G.MEAS_TYPE":
            return float(self._type)
        if name.startswith("V.E."):
            return float(self._external[self._external_names[name.removeprefix("V.E.")]])
        if name.startswith("V.P."):
            if name not in self._own:
                raise self._alarm(900113, block, name=name)
            return self._own[name]
        stem, _, axis_upper = name.rpartition(".")
        axis = next(axis for axis in self._program.axes if axis.upper() == axis_upper)
        if stem == "V.A.MERF":
            return float(self._signalled[axis])
        if stem in _POSITIONS:
            return _POSITIONS[stem](self._coordinates, axis)
        return _RESULTS[stem](self._measured_value(block, axis, name))

    def _measured_value(self, block: Block, axis: str, asked_by: str) -> Measured:
        if axis not in self._measured:
            raise self._alarm(900101, block, axis=axis, name=asked_by)
        return self._measured[axis]

    def _feed(self, block: Block, word: str) -> float:
        if self._feed_mm_min is None or self._feed_mm_min <= 0:
            raise self._alarm(20008, block, word=word)
        return self._feed_mm_min

    # ---- refusals

    def _require_offset_type(self, block: Block, g_function: str) -> None:
        if measuring_types()[self._type].command != "G100":
            raise self._alarm(20772, block, g_function=g_function, type=self._type)

    def _check_external(self) -> None:
        for name, line, column in self._program.variables:
            key = name.removeprefix("V.E.")
            if name.startswith("V.E.") and key not in self._external_names:
                close = nearest(key, self._external)
                raise UserError(
                    "the PLC side has no such variable",
                    file=self._program.file,
                    line=line,
                    column=column,
                    value=name,
                    allowed=[f"V.E.{known}" for known in self._external] or "none",
                    hint=f"did you mean {', '.join(f'V.E.{k}' for k in close)}"
                    if close
                    else f"give it one: a column plc:{name}, or --set plc:{name}=<value>",
                )

    def _alarm(self, alarm_id: int, block: Block, **values: object) -> Alarm:
        file = "" if self._program.file is None else f"{self._program.file} "
        return Alarm(alarm_id, place=f"{file}{block}", **values)
