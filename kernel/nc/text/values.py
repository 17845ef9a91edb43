"""Expressions of the syntax tree: constants, variables, functions, ranks of operators."""

from collections.abc import Iterable, Sequence
from typing import Any

from lark import Token, Transformer, v_args
from lark.tree import Meta

from kernel.errors import UserError, nearest
from kernel.nc.expressions import NoValue, folded
from kernel.nc.syntax import (
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
from kernel.nc.text import nodes
from kernel.nc.text.source import Source
from kernel.nc.text.words import find_variable, spelled_variables, words

Part = Any  # what a rule of the grammar gives: a token or a node


def offset_of(token: Token) -> int:
    """Give where a token begins in the program text."""
    assert token.start_pos is not None
    return token.start_pos


@v_args(inline=True)
class ExpressionBuilder(Transformer[Token, Any]):
    """Builds expressions for one program; see `Builder`.

    variables: name -> (line, column) of the first place where a program reads or writes it.
    not_acting: the words of the block at hand that do not act. remarks: text, line and column of
    what was read in another way than it is written.
    """

    def __init__(self, source: Source, axes: Sequence[str]) -> None:
        super().__init__()
        self.source = source
        self.axes = {axis.upper(): axis for axis in axes}
        self.variables: dict[str, tuple[int, int]] = {}
        self.not_acting: list[NotActing] = []
        self.remarks: list[tuple[str, int, int]] = []

    # ---- leaves

    def number(self, token: Token) -> Number:
        """A constant."""
        return Number(self.digits(token, offset_of(token)))

    def text(self, token: Token) -> Text:
        """A constant text."""
        return Text(token[1:-1])

    def truth(self, token: Token) -> Number:
        """TRUE or FALSE."""
        return Number(float(token.upper() == "TRUE"))

    def group(self, value: nodes.Value) -> Expression:
        """An expression in [ ]."""
        return value.expression

    @v_args(inline=False)
    def index(self, children: list[Part]) -> tuple[tuple[Expression, ...], str]:
        """Indices in one bracket and the name that goes on behind it."""
        indices = tuple(part.expression for part in children if isinstance(part, nodes.Value))
        tail = next((str(part) for part in children if isinstance(part, Token)), "")
        return indices, tail

    @v_args(inline=False)
    def variable(self, children: list[Part]) -> Variable:
        """`V.P.NAME[1]`, `P1092`, `@P4`."""
        token, *parts = children
        if token.type == "PARAMETER":
            sign = token[0].upper()
            if sign != "@":
                return self._known(f"{sign}[]", (Number(float(token[1:])),), token)
            return self._known(token.upper(), (), token)
        return self._known(*_name_and_indices(token.upper(), parts), token)

    @v_args(inline=False)
    def parameter(self, children: list[Part]) -> Variable:
        """`P[expression]`."""
        token, *parts = children
        return self._known(*_name_and_indices(token.upper(), parts), token)

    # ---- functions and operators

    @v_args(inline=False)
    def function(self, children: list[Part]) -> Expression:
        """A function with its operands."""
        token, *values = children
        name, operands = token.upper(), tuple(value.expression for value in values)
        word = words("function").get(name)
        if word is None:
            raise self.unknown("function", name, offset_of(token), words("function"))
        least, _, most = word.group.partition("-")
        if not int(least) <= len(operands) <= int(most or least):
            raise self.source.error(
                f"{name} takes {word.group} operands", offset_of(token), value=len(operands)
            )
        if not word.acts:
            self.note(name, word.meaning, offset_of(token))
        return Not(operands[0]) if name == "NOT" else Call(name, operands)

    @v_args(inline=False)
    def factor(self, children: list[Part]) -> Expression:
        """An operand with its signs."""
        *signs, operand = children
        minus_signs = sum(str(sign) == "-" for sign in signs)
        return Negative(operand) if minus_signs % 2 else operand

    exponent = factor

    @v_args(inline=False)
    def _rank(self, children: list[Part]) -> Chain:
        first, *rest = children
        pairs = zip(rest[::2], rest[1::2], strict=True)
        return Chain(first, tuple((_SIGNS.get(s.upper(), s.upper()), o) for s, o in pairs))

    disjunction = exclusion = conjunction = comparison = _rank
    bits_or = bits_xor = bits_and = sum = product = power = _rank

    @v_args(inline=False, meta=True)
    def value(self, meta: Meta, children: list[Part]) -> nodes.Value:
        """A whole expression; constant if it has no variables."""
        if _is_left_open(children[0]):
            return nodes.Value(children[0], meta.start_pos)
        try:
            return nodes.Value(folded(children[0]), meta.start_pos)
        except NoValue as fault:
            raise self.source.error(f"expression has no value: {fault}", meta.start_pos) from None

    # ---- names

    def _known(self, name: str, indices: tuple[Expression, ...], token: Token) -> Variable:
        """Look a variable up in the table; raises UserError for one that nobody knows."""
        offset = offset_of(token)
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
        """Remember a word that the manuals know and that does not act yet."""
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


_SIGNS = {"OR": "||", "AND": "&&"}


def _name_and_indices(
    name: str, parts: Iterable[tuple[tuple[Expression, ...], str]]
) -> tuple[str, tuple[Expression, ...]]:
    indices: list[Expression] = []
    for inside, tail in parts:
        name += "[]" * len(inside) + tail.upper()
        indices.extend(inside)
    return name, tuple(indices)


def _is_left_open(expression: Expression) -> bool:
    """Whether only the decoder can work with it: a text, or a function that does not act."""
    match expression:
        case Text():
            return True
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
