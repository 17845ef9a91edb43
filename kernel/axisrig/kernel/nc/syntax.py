"""The checked program as plain data: expressions, statements, blocks.

Everything is frozen and compares by value. Names are upper case: `G1`, `M30`, `MEAS MODE`,
`V.A.MESS.X`; axes are spelled as the rig does. Only the text rooms make these, only the decoder
works them off.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.kernel.nc.block import Block

# ---- expressions


@dataclass(frozen=True)
class Number:
    """A constant, or an expression of constants already computed; TRUE is 1, FALSE is 0."""

    value: float


@dataclass(frozen=True)
class Text:
    """A constant text."""

    value: str


@dataclass(frozen=True)
class Variable:
    """A variable by its full name in upper case; every index is written as `[]` in the name.

    `V.G.KIN_STEP[1].ID[98].PARAM[0]` is `V.G.KIN_STEP[].ID[].PARAM[]` with three indices;
    `P1092` and `P[1092]` are both `P[]` with the index 1092.
    """

    name: str
    indices: tuple["Expression", ...] = ()


@dataclass(frozen=True)
class Negative:
    """The operand with the other sign."""

    operand: "Expression"


@dataclass(frozen=True)
class Not:
    """The logical opposite of the operand."""

    operand: "Expression"


@dataclass(frozen=True)
class Call:
    """A function with its operands."""

    function: str
    operands: tuple["Expression", ...]


@dataclass(frozen=True)
class Chain:
    """Operands of one rank worked off from left to right.

    first: the leftmost operand. rest: sign and operand, in order. The ranks, loosest first:
    `||`, `XOR`, `&&`, `== != < <= > >=`, bits `|`, `^`, `&`, `+ -`, `* / MOD`, `**`.
    """

    first: "Expression"
    rest: tuple[tuple[str, "Expression"], ...]


Expression = Number | Text | Variable | Negative | Not | Call | Chain

# ---- values of commands


@dataclass(frozen=True)
class Name:
    """A plain word as value.

    An axis is spelled as in the rig; the name of a drive function, a file or an ident as written;
    every other word is upper case.
    """

    value: str


@dataclass(frozen=True)
class Group:
    """Values in brackets of their own inside a command: `[X2=X,G,15,20]`."""

    arguments: tuple["Argument", ...] = ()
    options: tuple[tuple[str, "Option"], ...] = ()


# None: a gap between two commas
Argument = Expression | Name | Group | None
# None: a keyword without value (flag)
Option = Expression | Name | Group | None


@dataclass(frozen=True)
class Target:
    """Where a jump goes: `N100` or `[NAME]`."""

    label: str


# ---- statements


@dataclass(frozen=True)
class AxisCommand:
    """A command to a single axis: `X[INDP_SYN G100 POS=100 FEED=500]`.

    axis: as the rig spells it. name: the first word, such as `INDP_SYN`. options: keyword and
    value in their order; G and M functions are keywords without value.
    """

    axis: str
    name: str
    options: tuple[tuple[str, Option], ...] = ()
    arguments: tuple[Argument, ...] = ()


@dataclass(frozen=True)
class Words:
    """A block of words: what G and M functions, axis words and other addresses say together.

    g, m: functions in order, without leading zeros. axes: axis and value, in order.
    addresses: letter (F I J K R T D S E H ...) and value, in order. axis_commands: commands to
    single axes. goto: the jump after G310.
    """

    g: tuple[str, ...] = ()
    m: tuple[str, ...] = ()
    axes: tuple[tuple[str, Expression], ...] = ()
    addresses: tuple[tuple[str, Expression], ...] = ()
    axis_commands: tuple[AxisCommand, ...] = ()
    goto: Target | None = None

    def address(self, letter: str) -> Expression | None:
        """Give the value of an address; None if the block does not have it."""
        return next((value for name, value in self.addresses if name == letter), None)

    @property
    def feed(self) -> Expression | None:
        """The value of F."""
        return self.address("F")


@dataclass(frozen=True)
class Command:
    """A # command. What it takes is a table: `text/commands.csv`.

    name: upper case with single blanks (`MEAS MODE`, `CS ON`, `SET AX LINK`). arguments: values
    by position. options: keyword and value in their order; a keyword may repeat. remark: how it was
    read where that is not as it is written, else empty.
    """

    name: str
    arguments: tuple[Argument, ...] = ()
    options: tuple[tuple[str, Option], ...] = ()
    remark: str = field(default="", compare=False)

    def option(self, keyword: str) -> Option:
        """Give the value of a keyword; None for a flag and for a keyword that is not there."""
        return next((value for name, value in self.options if name == keyword), None)

    def has(self, keyword: str) -> bool:
        """Return whether a keyword is in the command."""
        return any(name == keyword for name, _ in self.options)


@dataclass(frozen=True)
class Assign:
    """A variable gets a value."""

    target: Variable
    value: Expression


@dataclass(frozen=True)
class Declare:
    """A variable of #VAR ... #ENDVAR: `V.P.NAME[2][3] = [1,2,3,4,5,6]`.

    target: the name with `[]` per dimension; its indices are the sizes. values: the first values
    in the order of the indices, last index fastest; empty for none. kind: the type after the
    colon (`UNS32`, `STRING`), REAL64 where none is written.
    """

    target: Variable
    values: tuple[Expression, ...] = ()
    kind: str = "REAL64"


@dataclass(frozen=True)
class If:
    """$IF."""

    condition: Expression


@dataclass(frozen=True)
class ElseIf:
    """$ELSEIF."""

    condition: Expression


@dataclass(frozen=True)
class Else:
    """$ELSE."""


@dataclass(frozen=True)
class EndIf:
    """$ENDIF."""


@dataclass(frozen=True)
class For:
    """$FOR variable = first, last, step."""

    variable: Variable
    first: Expression
    last: Expression
    step: Expression


@dataclass(frozen=True)
class EndFor:
    """$ENDFOR."""


@dataclass(frozen=True)
class While:
    """$WHILE."""

    condition: Expression


@dataclass(frozen=True)
class EndWhile:
    """$ENDWHILE."""


@dataclass(frozen=True)
class Do:
    """$DO."""


@dataclass(frozen=True)
class EndDo:
    """$ENDDO: the loop goes on as long as the condition holds."""

    condition: Expression


@dataclass(frozen=True)
class Repeat:
    """$REPEAT."""


@dataclass(frozen=True)
class Until:
    """$UNTIL: the loop ends as soon as the condition holds."""

    condition: Expression


@dataclass(frozen=True)
class Switch:
    """$SWITCH."""

    value: Expression


@dataclass(frozen=True)
class Case:
    """$CASE."""

    value: Expression


@dataclass(frozen=True)
class Default:
    """$DEFAULT."""


@dataclass(frozen=True)
class EndSwitch:
    """$ENDSWITCH."""


@dataclass(frozen=True)
class Break:
    """$BREAK."""


@dataclass(frozen=True)
class Continue:
    """$CONTINUE."""


@dataclass(frozen=True)
class Goto:
    """$GOTO; with a condition it is the one-line form `$IF condition $GOTO target`."""

    target: Target
    condition: Expression | None = None


@dataclass(frozen=True)
class Label:
    """The place a jump goes to, named as in `Target`."""

    name: str


@dataclass(frozen=True)
class SubprogramCall:
    """The call of a subprogram.

    name: as written. scope: `local` (LL name), `global` (L name) or `cycle` (L CYCLE [...]).
    parameters: keyword and value of a cycle, `@P1` or `@S1`.
    """

    name: str
    scope: str
    parameters: tuple[tuple[str, Option], ...] = ()


Branching = If | ElseIf | Else | EndIf | Switch | Case | Default | EndSwitch
Looping = For | EndFor | While | EndWhile | Do | EndDo | Repeat | Until | Break | Continue
Control = Branching | Looping | Goto | Label
Statement = Words | Command | Assign | Declare | SubprogramCall | Control


@dataclass(frozen=True)
class NotActing:
    """A word that the manuals contain and the kernel does not carry out (yet).

    word: as written in a program. what: what it means. line, column: where it is, from 1.
    """

    word: str
    what: str
    line: int
    column: int


@dataclass(frozen=True)
class ProgramBlock:
    """One block and what it does; statement None for a block number alone.

    A block that does several things in turn (a label, assignments, words) gives one of these for
    each, with the same `block`. skip: the level of block skip `/`, 0 without. not_acting: the
    words for which the decoder raises alarm 900100 when it gets here.
    """

    block: Block
    statement: Statement | None
    skip: int = 0
    not_acting: tuple[NotActing, ...] = ()


@dataclass(frozen=True)
class Program:
    """A program in which every word has been checked.

    name: what follows `%`, empty without. blocks: the main program. subprograms: the local
    ones by name as written after `%L`. variables: every variable it reads or writes, with the
    line and column of the first place. axes: the axes it was checked for, main axes first.
    """

    name: str
    file: str | None
    axes: tuple[str, ...]
    blocks: tuple[ProgramBlock, ...]
    variables: tuple[tuple[str, int, int], ...]
    subprograms: Mapping[str, tuple[ProgramBlock, ...]] = field(default_factory=dict)
