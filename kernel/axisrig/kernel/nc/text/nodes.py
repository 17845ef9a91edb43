"""What the grammar makes of a block before its words are looked up: plain nodes with places.

Every offset counts from the beginning of the program text.
"""

from dataclasses import dataclass

from axisrig.kernel.nc.syntax import Expression, Target, Variable


@dataclass(frozen=True)
class Value:
    """An expression and where it begins."""

    expression: Expression
    offset: int


@dataclass(frozen=True)
class Bare:
    """A word without value, as written."""

    text: str
    offset: int


@dataclass(frozen=True)
class Entry:
    """One thing between the commas of a bracket: `KEYWORD=value`, or a value without keyword."""

    keyword: str | None
    value: "Value | Bare | Bracket"
    offset: int


@dataclass(frozen=True)
class Bracket:
    """A bracket: for each part between commas what is there, empty for a gap."""

    elements: tuple[tuple[Entry, ...], ...]
    offset: int


@dataclass(frozen=True)
class Word:
    """`X10`, `X=10`, `XP1`: an address with its digits as written, or with an expression."""

    address: str
    value: "Expression | str"
    offset: int
    assigned: bool = False

    @property
    def as_written(self) -> str:
        """The word, or its address if an expression follows it."""
        return f"{self.address}{self.value}" if isinstance(self.value, str) else self.address


@dataclass(frozen=True)
class Opened:
    """`X[...]`, and `P[...] = value`."""

    address: str
    bracket: Bracket
    value: Expression | None
    offset: int


@dataclass(frozen=True)
class Setting:
    """`V.P.NAME = value`."""

    variable: Variable
    value: Expression
    offset: int


@dataclass(frozen=True)
class Lone:
    """A value without address: the time after G4."""

    value: Expression
    offset: int


@dataclass(frozen=True)
class Jump:
    """`$GOTO target`."""

    target: Target
    offset: int


@dataclass(frozen=True)
class RawCommand:
    """A # command: its words in upper case and as written, what follows it."""

    words: tuple[str, ...]
    brackets: tuple[Bracket, ...]
    loose: Bracket | None
    offset: int


@dataclass(frozen=True)
class Call:
    """The call of a subprogram: local (LL) or global (L); a bracket for a cycle."""

    local: bool
    name: str
    bracket: Bracket | None
    offset: int


@dataclass(frozen=True)
class Head:
    """What is before a block: level of block skip, block number, label."""

    skip: int = 0
    number: int | None = None
    label: str | None = None
    placeholder: int | None = None
