"""What the topics of the decoder share: the program, the machine, modal state, values, alarms."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Protocol, TypeVar

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import Coordinates, OffsetTables
from axisrig.kernel.nc.coordinates.lists import INCH_MM
from axisrig.kernel.nc.decoder.base.cells import whole_index
from axisrig.kernel.nc.decoder.base.frames import Flow
from axisrig.kernel.nc.expressions import (
    DivisionByZero,
    NoValue,
    Value,
    evaluate,
    is_true,
    value_of,
    whole_number,
)
from axisrig.kernel.nc.syntax import Expression, Number, Program, Variable, Words

Part = TypeVar("Part")


class ChannelControl(NamedTuple):
    """3D distance control, as a program may ask for it.

    plane: in which coordinates its offset may change now (ACS, ECS, MCS); None while no axis offset
    changes. is_licensed: the option is there.
    """

    plane: str | None = None
    is_licensed: bool = True


class MachineView(Protocol):
    """What the decoder reads from the machine, at the start and after each `Wait`."""

    def position_acs_mm(self, axis: str) -> float:
        """Give the axis position of the interpolation."""
        ...

    def measured_acs_mm(self, axis: str) -> float | None:
        """Give the axis position latched in the last run; None without a valid value."""
        ...

    def measurement_ok(self, axis: str) -> bool:
        """Return whether the signal of the last run came before the target."""
        ...

    def is_measuring(self, axis: str) -> bool:
        """Return whether a run of the axis is under way."""
        ...

    def actual_acs_mm(self, axis: str) -> float:
        """Give the actual position of an axis."""
        ...

    def may_measure(self, axis: str) -> bool:
        """Return whether an axis is a measuring axis (P-AXIS-00118)."""
        ...

    def is_sercos(self, axis: str) -> bool:
        """Return whether the drive of an axis speaks SERCOS."""
        ...

    def axis_numbered(self, number: int) -> str | None:
        """Give the axis with a logical number (P-AXIS-00016), None when there is none."""
        ...

    def distance_state(self, axis: str) -> str | None:
        """Give the state of the distance control of an axis (ACTIVE, ..); None without one."""
        ...

    def channel_distance(self) -> ChannelControl | None:
        """Give the 3D distance control of the channel; None where P-CHAN-00500 is without it."""
        ...

    def drive_value(self, axis: str, key: str) -> float:
        """Give what the last `DriveRead` of this axis and function returned."""
        ...


class VariableAccess(Protocol):
    """Who reads and writes variables, all topics together (`registry`)."""

    def read(self, context: "Context", block: Block, variable: Variable) -> Value:
        """Give the value of a variable."""
        ...

    def write(
        self, context: "Context", block: Block, variable: Variable, value: Value
    ) -> Iterator[canon.Command]:
        """Give a variable a value; what the machine has to do for it is yielded."""
        ...


EDGE_BANDING: Final[Mapping[str, str]] = {
    "G108": "TF5200 programming manual 206213899",
    "G107": "TF5200 programming manual 206224907",
    "#MEAS [TRIGGER]": "TF5200 channel parameters 149024651, P-CHAN-00257",
    "#MEAS [G107]": "TF5200 programming manual 207092107",
    "#MEAS [G108]": "TF5200 programming manual 207092107",
}
"""Words of edge banding, a measurement that an M function (MNE_SNS) begins; their sections."""


@dataclass
class Modal:
    """What stays from block to block.

    motion: the G function of a block with nothing but axis words. G1 without F is an alarm;
    starting in rapid would move before anyone said so. inch: G70. zero_group: the last of G53 to
    G59, 0 to 6; None before the first.
    """

    motion: str = "G1"
    absolute: bool = True
    feed_mm_min: float | None = None
    inch: bool = False
    zero_group: int | None = None


class Context:
    """The state of one decoding, handed to every handler.

    external: values of `V.E.<name>` by name, those of the moment. default_measuring_type:
    P-CHAN-00057. flow: the open calls. tables: zero offsets and tools as the rig has them; the
    program works on copies. ends: set by the block that ends the program. passed_over: published
    words that count for nothing (`#TIMER`, `G25`).
    """

    def __init__(
        self,
        program: Program,
        machine: MachineView,
        external: Mapping[str, float],
        default_measuring_type: int,
        flow: Flow,
        variables: VariableAccess,
        tables: OffsetTables | None = None,
    ) -> None:
        self.program, self.machine = program, machine
        self.axes: Sequence[str] = program.axes
        self.external = external
        self.default_measuring_type = default_measuring_type
        self.modal = Modal()
        self.coordinates = Coordinates(program.axes, dict.fromkeys(program.axes, 0.0))
        self.tables = tables or OffsetTables()
        self.zero_offsets = self.tables.zero_offsets.copy()
        self.tools = self.tables.tools.copy()
        self.flow = flow
        self.ends = False
        self.passed_over: frozenset[str] = frozenset()
        self._variables = variables
        self._parts: dict[type, object] = {}

    def begin(self) -> None:
        """Take over where the axes are, which the machine reports when the program begins."""
        self.coordinates = Coordinates(
            self.program.axes,
            {axis: self.machine.position_acs_mm(axis) for axis in self.program.axes},
        )
        self.select_zero(self.zero_offsets.default_group)

    def select_zero(self, group: int) -> None:
        """Take a group of zero offsets into use."""
        offsets = [self.zero_offsets.shift_mm(group, at) for at in range(len(self.axes))]
        self.coordinates.select_zero(group, offsets)

    def part(self, kind: type[Part]) -> Part:
        """Give the state that one topic keeps; made without arguments when first asked for."""
        if kind not in self._parts:
            self._parts[kind] = kind()
        found = self._parts[kind]
        assert isinstance(found, kind)
        return found

    def keep(self, part: object) -> None:
        """Put the state of one topic in place of what `part` gave before."""
        self._parts[type(part)] = part

    def axis(self, upper: str) -> str:
        """Give the name of an axis as the rig spells it; upper: checked to be one."""
        return next(axis for axis in self.axes if axis.upper() == upper)

    def indexed_axis(self, block: Block, upper: str, indices: list[int]) -> str:
        """Give the axis of a variable: by name in upper case, or by an index from 0."""
        if upper:
            return self.axis(upper)
        (index,) = indices
        if index >= len(self.axes):
            raise self.index_alarm(block, "V[]", index, len(self.axes) - 1)
        return self.axes[index]

    def numbered_axis(self, block: Block, expression: Expression) -> str:
        """Give the axis of a logical number (P-AXIS-00016); raises Alarm 20312 without one."""
        number = self.value(block, expression)
        whole = whole_number(number)
        axis = None if whole is None else self.machine.axis_numbered(whole)
        if axis is None:
            raise self.alarm(20312, block, number=f"{number:g}")
        return axis

    def require_free(self, block: Block, axes: Iterable[str], word: str) -> None:
        """Raise Alarm 900482 for an axis that the kinematic which is on contains."""
        kinematic, inside = self.coordinates.kinematic, self.coordinates.kinematic_axes
        for axis in axes:
            if kinematic is not None and axis in inside:
                raise self.alarm(900482, block, axis=axis, name=kinematic.name, word=word)

    def index_alarm(self, block: Block, name: str, index: int, last: int) -> Alarm:
        """Make the alarm of an index that is too large."""
        return self.alarm(20403, block, name=name, value=index, lower=0, upper=last)

    # ---- values

    def indices(self, block: Block, variable: Variable) -> list[int]:
        """Give the indices of a variable; raises Alarm 20403 for one that is no whole number."""
        found = []
        for expression in variable.indices:
            value = self.value(block, expression)
            index = whole_index(value)
            if index is None:
                upper, shown = "the last element", f"{value:.10g}"
                raise self.alarm(
                    20403, block, name=variable.name, value=shown, lower=0, upper=upper
                )
            found.append(index)
        return found

    def number(self, block: Block, value: Value) -> float:
        """Take a value as a number; raises Alarm 900105 for a text."""
        if isinstance(value, str):
            raise self.alarm(900105, block, reason=f"'{value}' is no number")
        return value

    def value(self, block: Block, expression: Expression) -> float:
        """Give the number an expression means.

        Raises Alarm 20396 for a division by 0 and 900105 for everything else without a value.
        """
        if isinstance(expression, Number):
            return expression.value
        try:
            return evaluate(expression, lambda variable: self.read(block, variable))
        except NoValue as fault:
            raise self._no_value(block, fault) from None

    def any_value(self, block: Block, expression: Expression) -> Value:
        """Give the number or the text an expression means; raises as `value`."""
        try:
            return value_of(expression, lambda variable: self.read(block, variable))
        except NoValue as fault:
            raise self._no_value(block, fault) from None

    def _no_value(self, block: Block, fault: NoValue) -> Alarm:
        if isinstance(fault, DivisionByZero):
            return self.alarm(20396, block, value=f"{fault.dividend:g}")
        return self.alarm(900105, block, reason=str(fault))

    def holds(self, block: Block, condition: Expression) -> bool:
        """Return whether a condition holds."""
        return is_true(self.value(block, condition))

    @property
    def unit_mm(self) -> float:
        """How many mm a programmed length of 1 is: 25.4 under G70."""
        return INCH_MM if self.modal.inch else 1.0

    def mm(self, axis: str, programmed: float) -> float:
        """Give a programmed coordinate in mm; for a rotary axis it is in degrees anyway."""
        turns = axis in self.tables.rotary
        return programmed if turns or not self.modal.inch else programmed * INCH_MM

    def shown(self, axis: str, value_mm: float) -> float:
        """Give a coordinate in the unit that the program has chosen, as V.A. variables read it.

        Source: TF5200 programming manual 207902603 (unit for input and output: mm, inch).
        """
        turns = axis in self.tables.rotary
        return value_mm if turns or not self.modal.inch else value_mm / INCH_MM

    def axis_values(self, block: Block, words: Words) -> dict[str, float]:
        """Give the coordinates or distances of the axis words in mm, in their order."""
        return {axis: self.mm(axis, value) for axis, value in self.axis_factors(block, words)}

    def axis_factors(self, block: Block, words: Words) -> list[tuple[str, float]]:
        """Give the values of the axis words as they are written: factors, or of no meaning."""
        return [(axis, self.value(block, value)) for axis, value in words.axes]

    def read(self, block: Block, variable: Variable) -> Value:
        """Give the value of a variable."""
        return self._variables.read(self, block, variable)

    def write(self, block: Block, variable: Variable, value: Value) -> Iterator[canon.Command]:
        """Give a variable a value; what the machine has to do for it is yielded."""
        yield from self._variables.write(self, block, variable, value)

    def feed(self, block: Block, word: str) -> float:
        """Give the feed in mm/min; raises Alarm 20008 without one above 0."""
        feed_mm_min = self.modal.feed_mm_min
        if feed_mm_min is None or feed_mm_min <= 0:
            raise self.alarm(20008, block, word=word)
        return feed_mm_min

    # ---- alarms

    def alarm(self, alarm_id: int, block: Block, **values: object) -> Alarm:
        """Make an alarm with file, line and block number as its place."""
        return Alarm(alarm_id, place=self.place(block), **values)

    def place(self, block: Block) -> str:
        """Give file, line and block number."""
        return str(block) if self.flow.file is None else f"{self.flow.file} {block}"

    def not_acting(self, block: Block, word: str, what: str) -> Alarm:
        """Make the alarm of a word that the manuals contain and the kernel does not carry out.

        900430 for a word of edge banding, else 900100.
        """
        if word in EDGE_BANDING:
            return self.alarm(900430, block, word=word, section=EDGE_BANDING[word])
        return self.alarm(900100, block, word=word, what=what)
