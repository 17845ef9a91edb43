"""Expressions of the syntax tree: constants, variables, functions, ranks of operators."""

import re
from collections.abc import Iterable, Sequence
from typing import Any

from lark import Token, Transformer, v_args

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.expressions import NoValue, folded
from axisrig.kernel.nc.syntax import (
    Call,
    Chain,
    Expression,
    Negative,
    Not,
    NotActing,
    Number,
    Text,
    Variable,
)
from axisrig.kernel.nc.text import nodes
from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.words import find_variable, spelled_variables, words

Part = Any  # what a rule of the grammar gives: a token or a node


@v_args(inline=True)
class ExpressionBuilder(Transformer[Token, Any]):
    """Builds expressions, for one program after the other; see `Builder`.

    begin: where the block at hand begins in the program text. variables: name -> (line, column) of
    the first place where a program reads or writes it. not_acting: the words of the block at hand
    that do not act. remarks: text, line and column of what was read in another way than it is
    written.
    """

    def __init__(self) -> None:
        super().__init__()
        self.use(Source("", None), ())

    def use(self, source: Source, axes: Sequence[str]) -> None:
        """Go on with another program, on a rig with these axes."""
        self.source = source
        self.axes = {axis.upper(): axis for axis in axes}
        self.variables: dict[str, tuple[int, int]] = {}
        self.begin = 0
        self.not_acting: list[NotActing] = []
        self.remarks: list[tuple[str, int, int]] = []

    def at(self, token: Token) -> int:
        """Give where a token of the block at hand begins in the program text."""
        assert token.start_pos is not None
        return self.begin + token.start_pos

    # ---- leaves

    def number(self, token: Token) -> nodes.Value:
        """A constant."""
        return nodes.Value(Number(self.digits(token, self.at(token))), self.at(token))

    def text(self, token: Token) -> nodes.Value:
        """A constant text."""
        return nodes.Value(Text(token[1:-1]), self.at(token))

    def truth(self, token: Token) -> nodes.Value:
        """TRUE or FALSE."""
        return nodes.Value(Number(float(token.upper() == "TRUE")), self.at(token))

    def group(self, token: Token, value: nodes.Value) -> nodes.Value:
        """An expression in [ ]."""
        return nodes.Value(value.expression, self.at(token))

    @v_args(inline=False)
    def index(self, children: list[Part]) -> tuple[tuple[Expression, ...], str]:
        """Indices in one bracket and the name that goes on after it."""
        indices = tuple(part.expression for part in children if isinstance(part, nodes.Value))
        tail = next((str(part) for part in children if isinstance(part, Token)), "")
        return indices, tail

    @v_args(inline=False)
    def variable(self, children: list[Part]) -> nodes.Value:
        """`V.P.NAME[1]`, `P1092`, `P[expression]`, `@P4`."""
        token, *parts = children
        name = token.upper()
        indices: tuple[Expression, ...] = ()
        if token.type in ("PARAMETER", "R_PARAMETER") and (match := NUMBERED.fullmatch(name)):
            name, indices = f"{match['sign']}[]", (Number(float(match["number"])),)
        elif parts:
            name, indices = _name_and_indices(name, parts)
        return nodes.Value(self.known(name, indices, self.at(token)), self.at(token))

    parameter = variable

    # ---- functions and operators

    @v_args(inline=False)
    def function(self, children: list[Part]) -> nodes.Value:
        """A function with its operands."""
        token, *values = children
        name, operands = token.upper(), tuple(value.expression for value in values)
        word = words("function").get(name)
        if word is None:
            raise self.unknown("function", name, self.at(token), words("function"))
        least, _, most = word.group.partition("-")
        if not int(least) <= len(operands) <= int(most or least):
            number = word.group.replace("-", " to ")
            noun = "operand" if number == "1" else "operands"
            raise self.source.error(
                f"{name} takes {number} {noun}", self.at(token), value=len(operands)
            )
        if not word.acts:
            self.note(name, word.meaning, self.at(token))
        call = Not(operands[0]) if name == "NOT" else Call(name, operands)
        return nodes.Value(call, self.at(token))

    @v_args(inline=False)
    def operand(self, children: list[Part]) -> nodes.Value:
        """An operand with its signs; a sign is worked off after a power: -2**2 is -4."""
        *signs, value = children
        if not signs:
            return nodes.Value(value.expression, value.offset)
        minus_signs = sum(str(sign) == "-" for sign in signs)
        expression = Negative(value.expression) if minus_signs % 2 else value.expression
        return nodes.Value(expression, self.at(signs[0]))

    @v_args(inline=False)
    def value(self, children: list[Part]) -> nodes.Value:
        """A whole expression; constant if it has no variables."""
        offset = children[0].offset
        operands = [part.expression for part in children[::2]]
        signs = [_SIGNS.get(sign, sign) for sign in map(str.upper, children[1::2])]
        expression = _ranked(operands, signs) if signs else operands[0]
        if isinstance(expression, Number | Text | Variable) or _is_left_open(expression):
            return nodes.Value(expression, offset)
        try:
            return nodes.Value(folded(expression), offset)
        except NoValue as fault:
            raise self.source.error(f"expression has no value: {fault}", offset) from None

    # ---- names

    def known(self, name: str, indices: tuple[Expression, ...], offset: int) -> Variable:
        """Look a variable up in the table; raises UserError for one that does not exist."""
        row, axis = find_variable(name)
        if row is None:
            known = spelled_variables(tuple(self.axes))
            raise self.unknown("variable", name, offset, known, hint_only=True)
        if axis is not None and axis not in self.axes:
            raise self.source.error(
                "the rig has no such axis",
                offset,
                value=axis,
                allowed=self.axes.values(),
                hint=f"in {name}",
            )
        if not row.acts:
            self.note(name, row.meaning, offset)
        self.variables.setdefault(name, self.source.place(offset))
        return Variable(name, indices)

    def note(self, word: str, what: str, offset: int) -> None:
        """Remember a word that the manuals contain and that does not act yet."""
        self.not_acting.append(NotActing(word, what, *self.source.place(offset)))

    def remark(self, text: str, offset: int) -> None:
        """Remember that something was read in another way than it is written."""
        self.remarks.append((text, *self.source.place(offset)))

    def unknown(
        self,
        kind: str,
        name: str,
        offset: int,
        known: Iterable[str],
        *,
        hint_only: bool = False,
    ) -> UserError:
        """Make the error of an unknown name with the nearest ones; hint_only: too many to list."""
        known = list(known)
        close = nearest(name, known)
        return self.source.error(
            f"unknown {kind}",
            offset,
            value=name,
            allowed=None if hint_only and close else known,
            hint=f"nearest: {', '.join(close)}" if close else None,
        )

    def digits(self, digits: str, offset: int) -> float:
        """Read a number; raises UserError for one that a float cannot hold."""
        if digits[:2] in ("0x", "0X"):
            value = float(int(digits, 16)) if len(digits) < 18 else float("inf")
        else:
            value = float(digits)
        if value in (float("inf"), float("-inf")):
            raise self.source.error("number too large", offset, value=f"{digits[:12]}..")
        return value


# P1092, R5, @P4
NUMBERED = re.compile(r"(?P<sign>[PR]|@[PS])(?P<number>[0-9]+)")
_SIGNS = {"OR": "||", "AND": "&&"}
# Loosest first; operands of one rank are worked off from left to right.
# Source: TF5200 programming manual 206014219.
RANKS = (
    ("||",),
    ("XOR",),
    ("&&",),
    ("==", "!=", "<", "<=", ">", ">="),
    ("|",),
    ("^",),
    ("&",),
    ("+", "-"),
    ("*", "/", "MOD"),
    ("**",),
)


def _ranked(operands: list[Expression], signs: list[str], rank: int = 0) -> Expression:
    """Put operands and the signs between them together, rank by rank."""
    while signs and not any(sign in RANKS[rank] for sign in signs):
        rank += 1
    if not signs:
        return operands[0]
    parts: list[Expression] = []
    between: list[str] = []
    begin = 0
    for place, sign in enumerate([*signs, RANKS[rank][0]]):
        if sign in RANKS[rank]:
            part_signs = signs[begin:place]
            parts.append(_ranked(operands[begin : place + 1], part_signs, rank + 1))
            begin = place + 1
            between.append(sign)
    pairs = tuple(zip(between[:-1], parts[1:], strict=True))
    first = parts[0]
    if rank == len(RANKS) - 1 and isinstance(first, Negative):
        return Negative(Chain(first.operand, pairs))
    return Chain(first, pairs)


def _name_and_indices(
    name: str, parts: Iterable[tuple[tuple[Expression, ...], str]]
) -> tuple[str, tuple[Expression, ...]]:
    indices: list[Expression] = []
    for inside, tail in parts:
        name += "[]" * len(inside) + tail.upper()
        indices.extend(inside)
    return name, tuple(indices)


def _is_left_open(expression: Expression) -> bool:
    """Whether a function that does not act takes part, so that nobody can compute it."""
    match expression:
        case Negative(operand) | Not(operand):
            return _is_left_open(operand)
        case Call(function, operands):
            return not words("function")[function].acts or any(
                _is_left_open(operand) for operand in operands
            )
        case Chain(first, rest):
            return _is_left_open(first) or any(_is_left_open(operand) for _, operand in rest)
        case _:
            return False
