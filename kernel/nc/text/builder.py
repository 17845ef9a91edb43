"""From the syntax tree of one block to a checked statement.

Every check that needs the text alone is made here, so that a program is refused before anything
moves: unknown words, words that do not act yet, words that exclude each other, axes the rig does
not have, arguments of # commands, constant values out of range.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from lark import Token, Transformer, v_args
from lark.tree import Meta

from kernel.errors import UserError, nearest
from kernel.nc.expressions import NoValue, folded
from kernel.nc.syntax import (
    Call,
    Chain,
    Expression,
    Negative,
    Number,
    Statement,
    Text,
    Variable,
    Words,
)
from kernel.nc.text.commands import (
    Argument,
    CommandText,
    command_name,
    command_statement,
    not_acting,
)
from kernel.nc.text.source import Source
from kernel.nc.text.words import Word, variables, words

# Axis words of a block serve one of these; without any of them the block is a move.
TAKES_AXES = ("G92", "G100", "G101", "G102", "G210", "G310")
NEEDS_AXES = ("G92", "G100", "G101", "G210", "G310")


@dataclass(frozen=True)
class _Item:
    """One word of a block: its address or axis as written, the value, the place."""

    address: str
    value: Expression | str
    offset: int

    @property
    def as_written(self) -> str:
        return f"{self.address}{self.value}" if isinstance(self.value, str) else self.address


@v_args(inline=True)
class Builder(Transformer[Token, "tuple[int | None, Statement | None]"]):
    """Builds the statements of one program.

    axes: the axes of the rig, main axes first. variables_read: name -> (line, column) of the first
    place, filled while building. Every method raises UserError for what cannot be accepted.
    """

    def __init__(self, source: Source, axes: Sequence[str]) -> None:
        super().__init__()
        self._source = source
        self._axes = {axis.upper(): axis for axis in axes}
        self.variables_read: dict[str, tuple[int, int]] = {}

    # ---- expressions

    def number(self, token: Token) -> Number:
        """A constant."""
        return Number(self._float(token, token))

    def variable(self, token: Token) -> Variable:
        """A variable of the table, for an axis of the rig."""
        name = token.upper()
        self._check_variable(name, token)
        self.variables_read.setdefault(name, self._source.place(_offset(token)))
        return Variable(name)

    def call(self, token: Token, operand: Expression) -> Call:
        """A function with its operand."""
        function = token.upper()
        word = words("function").get(function)
        if word is None:
            raise self._unknown("function", function, _offset(token), _acting("function"))
        if not word.acts:
            raise not_acting(self._source, _offset(token), function, word)
        return Call(function, (operand,))

    def group(self, operand: Expression) -> Expression:
        """An expression in [ ]."""
        return operand

    def factor(self, *children: Token | Expression) -> Expression:
        """An operand with its signs."""
        *signs, operand = children
        assert not isinstance(operand, Token)
        minus_signs = sum(str(sign) == "-" for sign in signs)
        return Negative(operand) if minus_signs % 2 else operand

    def product(self, first: Expression, *rest: Token | Expression) -> Expression:
        """Operands with * and /."""
        return _chain(first, rest)

    @v_args(inline=False, meta=True)
    def sum(self, meta: Meta, children: list[Token | Expression]) -> Expression:
        """Operands with + and -; constant if it has no variables."""
        first, *rest = children
        assert not isinstance(first, Token)
        try:
            return folded(_chain(first, rest))
        except NoValue as fault:
            raise self._source.error(f"expression has no value: {fault}", meta.start_pos) from None

    # ---- words

    def number_word(self, token: Token) -> _Item:
        """A word such as X10."""
        return _Item(token[0].upper(), token[1:].strip(" \t"), _offset(token))

    def assigned_word(self, token: Token, value: Expression) -> _Item:
        """A word such as X=10*2."""
        return _Item(token.upper(), value, _offset(token))

    def block(self, *children: "Token | _Item | Statement") -> tuple[int | None, Statement | None]:
        """A whole block: number and statement."""
        number = None
        if children and isinstance(children[0], Token):
            number = int(self._float(children[0][1:].strip(" \t"), children[0]))
        items = [child for child in children if isinstance(child, _Item)]
        if items:
            return number, self._words(items)
        statements = (child for child in children if not isinstance(child, Token | _Item))
        return number, next(statements, None)

    def _words(self, items: Sequence[_Item]) -> Words:
        functions: list[tuple[_Item, Word]] = []
        axes: dict[str, Expression] = {}
        feed: Expression | None = None
        for item in items:
            if item.address in ("G", "M"):
                functions.append((item, self._function(item)))
            elif item.address == "F":
                if feed is not None:
                    raise self._source.error("second feed in one block", item.offset, value="F")
                feed = self._feed(item)
            else:
                axis = self._axis(item)
                if axis in axes:
                    raise self._source.error("axis twice in one block", item.offset, value=axis)
                axes[axis] = self._item_value(item)
        self._check_groups(functions)
        g = tuple(word.word for _, word in functions if word.kind == "G")
        self._check_axis_words(functions, bool(axes))
        m = tuple(word.word for _, word in functions if word.kind == "M")
        addresses = () if feed is None else (("F", feed),)
        return Words(g, m, tuple(axes.items()), addresses)

    def _function(self, item: _Item) -> Word:
        """Find a G or M function; a leading zero of its number has no meaning."""
        if not isinstance(item.value, str) or not item.value.isdigit():
            raise self._source.error(
                f"{item.address} takes a whole number without sign",
                item.offset,
                value=item.as_written,
            )
        name = item.address + (item.value.lstrip("0") or "0")
        word = words(item.address).get(name)
        if word is None:
            raise self._unknown(
                f"{item.address} function", name, item.offset, _acting(item.address)
            )
        if not word.acts:
            raise not_acting(self._source, item.offset, name, word)
        return word

    def _feed(self, item: _Item) -> Expression:
        feed = self._item_value(item)
        if isinstance(feed, Number) and feed.value <= 0:
            raise self._source.error(
                "feed must move the axes",
                item.offset,
                value=f"F{feed.value:g}",
                allowed="greater than 0 mm/min",
            )
        return feed

    def _axis(self, item: _Item) -> str:
        axis = self._axes.get(item.address)
        if axis is not None:
            return axis
        if item.address == "N":
            raise self._source.error(
                "a block number stands at the beginning of its block",
                item.offset,
                value=item.as_written,
            )
        if item.address.startswith("V."):
            raise self._source.error(
                "variables can be read but not written yet", item.offset, value=item.address
            )
        word = words("address").get(item.address[0])
        if word is not None and re.fullmatch(r"[A-Z][0-9]*", item.address):
            raise not_acting(self._source, item.offset, item.as_written, word)
        raise self._source.error(
            "the rig has no such axis", item.offset, value=item.address, allowed=self._axes.values()
        )

    def _item_value(self, item: _Item) -> Expression:
        if isinstance(item.value, str):
            return Number(self._float(item.value, item.offset))
        return item.value

    def _check_groups(self, functions: Sequence[tuple[_Item, Word]]) -> None:
        by_group: dict[str, Word] = {}
        for item, word in functions:
            if word.group and word.group in by_group:
                raise self._source.error(
                    f"{by_group[word.group].word} and {word.word} exclude each other in one block",
                    item.offset,
                    value=word.word,
                    allowed=f"one word of the group '{word.group}'",
                )
            by_group[word.group] = word

    def _check_axis_words(self, functions: Sequence[tuple[_Item, Word]], has_axes: bool) -> None:
        for item, word in functions:
            if word.word in NEEDS_AXES and not has_axes:
                raise self._source.error(
                    f"{word.word} needs an axis",
                    item.offset,
                    value=word.word,
                    allowed=[f"{axis}.." for axis in self._axes.values()],
                )

    # ---- commands

    def argument(self, value: Token | Expression | None = None) -> Argument:
        """One value in the brackets of a command; None for a gap."""
        return Text(value[1:-1]) if isinstance(value, Token) else value

    def arguments(self, *children: Argument) -> tuple[Argument, ...]:
        """All values in the brackets of a command."""
        return children

    @v_args(inline=False, meta=True)
    def command(self, meta: Meta, children: list[Token | tuple[Argument, ...]]) -> Statement:
        """A # command with its brackets."""
        brackets = tuple(child for child in children if isinstance(child, tuple))
        name = command_name(str(children[0]))
        return command_statement(
            CommandText(self._source, tuple(self._axes.values()), name, brackets, meta.start_pos)
        )

    # ---- names

    def _check_variable(self, name: str, token: Token) -> None:
        row = next((row for row in variables() if row.matches(name)), None)
        if row is None:
            names = [row.name for row in variables() if row.acts]
            spelled = [name.replace("<axis>", axis) for name in names for axis in self._axes]
            raise self._unknown("variable", name, _offset(token), names, spelled)
        if not row.acts:
            raise self._source.error(
                f"known to the manuals but not acting yet ({row.meaning})",
                _offset(token),
                value=name,
            )
        axis = name.rpartition(".")[2]
        if row.name.endswith("<axis>") and axis not in self._axes:
            raise self._source.error(
                "the rig has no such axis",
                _offset(token),
                value=axis,
                allowed=self._axes.values(),
                hint=f"in {name}",
            )

    def _unknown(
        self,
        kind: str,
        name: str,
        offset: int,
        known: Iterable[str],
        spelled: Iterable[str] | None = None,
    ) -> UserError:
        """Make the error of an unknown name; spelled: the known names as a program has them."""
        close = nearest(name, known if spelled is None else spelled)
        return self._source.error(
            f"unknown {kind}",
            offset,
            value=name,
            allowed=known,
            hint=f"nearest: {', '.join(close)}" if close else None,
        )

    def _float(self, digits: str, place: Token | int) -> float:
        """Read a number; a float cannot hold one of more than 308 digits."""
        value = float(digits)
        if value in (float("inf"), float("-inf")):
            offset = place if isinstance(place, int) else _offset(place)
            raise self._source.error("number too large", offset, value=f"{digits[:12]}..")
        return value


def _chain(first: Expression, rest: Sequence[Token | Expression]) -> Expression:
    if not rest:
        return first
    pairs = zip(rest[::2], rest[1::2], strict=True)
    return Chain(first, tuple((str(s), o) for s, o in pairs if not isinstance(o, Token)))


def _acting(kind: str) -> Mapping[str, Word]:
    return {name: word for name, word in words(kind).items() if word.acts}


def _offset(token: Token) -> int:
    assert token.start_pos is not None
    return token.start_pos
