"""The checked program as plain data: expressions, statements, blocks."""

from dataclasses import dataclass

from kernel.nc.canon import Block


@dataclass(frozen=True)
class Number:
    """A constant, or an expression of constants already computed."""

    value: float


@dataclass(frozen=True)
class Variable:
    """A variable by its full name in upper case."""

    name: str


@dataclass(frozen=True)
class Negative:
    """The operand with the other sign."""

    operand: "Expression"


@dataclass(frozen=True)
class Call:
    """A function of one operand."""

    function: str
    operand: "Expression"


@dataclass(frozen=True)
class Chain:
    """Operands of one rank worked off from left to right.

    first: the leftmost operand. rest: sign (`+ -` or `* /`) and operand, in order.
    """

    first: "Expression"
    rest: tuple[tuple[str, "Expression"], ...]


Expression = Number | Variable | Negative | Call | Chain


@dataclass(frozen=True)
class Text:
    """A constant text, an argument of #MSG."""

    value: str


@dataclass(frozen=True)
class Words:
    """A block of words: what G functions, axis words, feed and end of program say together.

    g: G functions in order, without leading zeros. axes: axis and value, in order.
    """

    g: tuple[str, ...]
    axes: tuple[tuple[str, Expression], ...]
    feed: Expression | None
    ends_program: bool


@dataclass(frozen=True)
class MeasuringMode:
    """#MEAS MODE; measuring_type None chooses the default type of the channel."""

    measuring_type: Expression | None


@dataclass(frozen=True)
class SystemOn:
    """#CS ON with three shifts in mm and three angles in degrees, in the axis order."""

    components: tuple[Expression, ...]


@dataclass(frozen=True)
class SystemOff:
    """#CS OFF: the last one, or all."""

    all_systems: bool


@dataclass(frozen=True)
class MessageOut:
    """#MSG: text pieces and format elements (see `message.py`) with their arguments."""

    pieces: tuple["str | Format", ...]
    arguments: tuple[Expression | Text, ...]
    synchronous: bool


@dataclass(frozen=True)
class DriveWrite:
    """#DRIVE WR SYN: the value VAL for the function KEY of an axis; waits: WAIT."""

    axis: str
    key: str
    value: Expression
    waits: bool


@dataclass(frozen=True)
class DriveRead:
    """#DRIVE RD: the value of the function KEY of an axis into a variable V.P.<name>."""

    axis: str
    key: str
    variable: str


@dataclass(frozen=True)
class DriveWait:
    """#DRIVE WAIT SYN: until the drive of an axis has taken what was written before."""

    axis: str


@dataclass(frozen=True)
class Format:
    """One format element of a message: flags, width and precision as written, and the letter."""

    layout: str
    letter: str


Statement = (
    Words | MeasuringMode | SystemOn | SystemOff | MessageOut | DriveWrite | DriveRead | DriveWait
)


@dataclass(frozen=True)
class ProgramBlock:
    """One block and what it does; statement None for a block number alone."""

    block: Block
    statement: Statement | None


@dataclass(frozen=True)
class Program:
    """A program in which every word has been checked.

    name: what stands behind `%`, empty without. variables: every variable it reads, with the line
    and column of the first place. axes: the axes it was checked for, main axes first.
    """

    name: str
    file: str | None
    axes: tuple[str, ...]
    blocks: tuple[ProgramBlock, ...]
    variables: tuple[tuple[str, int, int], ...]
