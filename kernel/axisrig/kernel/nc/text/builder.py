"""From the syntax tree of one block to checked statements.

Every check that needs the text alone is made here, so that a program is refused before anything
moves: unknown words, words that exclude each other, axes the rig does not have, values out of
range. A word that is known and does not act is noted; the decoder raises the alarm for it.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from lark import Token, v_args

from axisrig.kernel.nc.syntax import (
    Assign,
    AxisCommand,
    Declare,
    Expression,
    Goto,
    Label,
    Number,
    Statement,
    Target,
    Text,
    Variable,
    Words,
)
from axisrig.kernel.nc.text import nodes
from axisrig.kernel.nc.text.commands import axis_command, cycle_call, hash_command
from axisrig.kernel.nc.text.controls import ControlBuilder
from axisrig.kernel.nc.text.published import published_g
from axisrig.kernel.nc.text.values import Part
from axisrig.kernel.nc.text.words import Word, words

# G functions with a value after `=`: what it is, and how it is written
VALUED = {
    "G159": ("group", "G159 = 0 .. 96"),
    **{name: ("weight in %", f"{name} = 70") for name in ("G131", "G133", "G134")},
}
NEEDS_AXES = ("G74", "G92", "G100", "G101", "G130", "G132", "G310", "G210")
# Their jump depends on the signal. Source: FCT-C4 section 3, type 5
_JUMP_BEHIND = {"G310", "G210"}
_FUNCTION_NUMBER = re.compile(r"[0-9]+")
_DWELL = re.compile(r"G0*4")
# R=5 and R1=5 are the radius of an arc. TF5200 programming manual 15556764811
_RADIUS = ("R", "R1")
# P1=5, R[2]=3 and @P4=1 set a parameter
_PARAMETER = re.compile(r"(?P<sign>[PR]|@[PS])(?P<number>[0-9]*)|@.*")

Block = tuple[nodes.Head, tuple[Statement, ...]]


@dataclass
class _Gathered:
    """What the words of one block say so far."""

    functions: list[tuple[nodes.Word, Word]] = field(default_factory=list)
    axes: dict[str, Expression] = field(default_factory=dict)
    addresses: list[tuple[str, Expression]] = field(default_factory=list)
    axis_commands: list[AxisCommand] = field(default_factory=list)
    assignments: list[Assign] = field(default_factory=list)
    goto: Target | None = None


@v_args(inline=True)
class Builder(ControlBuilder):
    """Builds the statements of a program while the grammar reads its blocks.

    Every method raises UserError for what cannot be accepted.
    """

    # ---- heads and labels

    @v_args(inline=False)
    def head(self, tokens: list[Token]) -> nodes.Head:
        """Block skip and block number."""
        skip, number, placeholder = 0, None, None
        for token in tokens:
            if token.type == "SKIP":
                skip = int(self.digits(token[1:] or "1", self.at(token)))
                self._check_skip(skip, token)
            elif token[1:].strip(" \t").isdigit():
                number = int(self.digits(token[1:].strip(" \t"), self.at(token)))
            else:
                placeholder = self.at(token)
        return nodes.Head(skip, number, None, placeholder)

    def _check_skip(self, level: int, token: Token) -> None:
        # Source: functional description of block skip, page 214611467: ten levels.
        if not 1 <= level <= 10:
            raise self.source.error(
                "no such level of block skip",
                self.at(token),
                value=str(token),
                allowed="/1 to /10",
            )

    def block(self, head: nodes.Head, colon: Part, label: Part, *parts: Part) -> Block:
        """A whole block: its head and what it does, in order."""
        statements: list[Statement] = []
        if colon is not None:
            if head.number is None:
                raise self.source.error(
                    "a label is a block number with a colon", self.at(colon), value=":"
                )
            statements.append(Label(f"N{head.number}"))
        if label is not None:
            statements.append(Label(label_name(label)))
        if len(parts) == 1 and not isinstance(parts[0], _ITEMS):
            statements.append(self._whole(parts[0]))
        else:
            statements.extend(self._items(parts))
        return head, tuple(statements)

    def _whole(self, part: Any) -> Statement:
        if isinstance(part, nodes.RawCommand):
            return hash_command(self, part)
        if isinstance(part, nodes.Call):
            return cycle_call(self, part)
        statement: Statement = part
        return statement

    @v_args(inline=False)
    def declaration(self, children: list[Part]) -> Block:
        """A line between #VAR and #ENDVAR."""
        head, variable, *after, values = children
        kind = next((str(part).upper() for part in after if isinstance(part, Token)), "REAL64")
        return head, (Declare(variable.expression, values or (), kind),)

    def size(self, token: Token) -> None:
        """The length of a text variable."""

    @v_args(inline=False)
    def initial(self, values: list[nodes.Value]) -> tuple[Expression, ...]:
        """First values of a variable."""
        return tuple(value.expression for value in values)

    # ---- words

    def number_word(self, token: Token) -> nodes.Word:
        """A word such as X10."""
        return nodes.Word(token[0].upper(), token[1:].strip(" \t"), self.at(token))

    def assigned_word(self, token: Token, value: nodes.Value) -> nodes.Word:
        """A word such as X=10*2."""
        return nodes.Word(token.upper(), value.expression, self.at(token), assigned=True)

    def letter_word(self, token: Token, value: nodes.Value) -> nodes.Word:
        """A word such as XV.P.START or XP1."""
        return nodes.Word(token.upper(), value.expression, self.at(token))

    def bracket_word(self, token: Token, bracket: nodes.Bracket, value: Part) -> nodes.Opened:
        """A word such as X[P1+5], X[INDP_SYN ..] or P[1]=5."""
        expression = None if value is None else value.expression
        return nodes.Opened(token.upper(), bracket, expression, self.at(token))

    def lone_number(self, token: Token) -> nodes.Lone:
        """The time after G4."""
        return nodes.Lone(Number(self.digits(token, self.at(token))), self.at(token))

    def lone_variable(self, variable: nodes.Value) -> nodes.Lone:
        """The time after G4."""
        return nodes.Lone(variable.expression, variable.offset)

    def setting(self, variable: nodes.Value, value: nodes.Value) -> nodes.Setting:
        """A variable that gets a value."""
        assert isinstance(variable.expression, Variable)
        return nodes.Setting(variable.expression, value.expression, variable.offset)

    def _items(self, items: Sequence[Any]) -> Iterator[Statement]:
        found = _Gathered()
        if any(map(_is_published, items)):
            yield self._published(items)
            return
        for item in items:
            if isinstance(item, nodes.Word):
                self._word(found, item)
            elif isinstance(item, nodes.Opened):
                self._opened(found, item)
            elif isinstance(item, nodes.Setting):
                found.assignments.append(Assign(item.variable, item.value))
            elif isinstance(item, nodes.Lone):
                self._dwell_time(found, item.value, item.offset)
            else:
                self._jump(found, item)
        yield from found.assignments
        if len(items) == len(found.assignments):
            return
        words_of_block = self._words(found)
        jumps_only = words_of_block == Words(goto=found.goto)
        if found.goto and not jumps_only and not _JUMP_BEHIND & set(words_of_block.g):
            raise self.source.error(
                "$GOTO is allowed alone, after assignments, or after G310 (G210)",
                self.source.place_of("$", self.begin),
                value="$GOTO",
                allowed="a block of its own",
                hint="only G310 and G210 jump when their motion ends by the signal",
            )
        yield Goto(found.goto) if jumps_only and found.goto else words_of_block

    def _published(self, items: Sequence[Any]) -> Words:
        """Make a block that ends the program at a published G function, without its values."""
        names = []
        for item in items:
            if isinstance(item, nodes.Word) and (name := _g_name(item)) is not None:
                names.append(name)
                if (row := published_g().get(name)) is not None:
                    self.note(name, row.meaning, item.offset)
                elif item.address == "G":
                    self._function(item)
        return Words(tuple(names))

    def _word(self, found: _Gathered, item: nodes.Word) -> None:
        if item.address in ("G", "M"):
            found.functions.append((item, self._function(item)))
            return
        if item.address in VALUED:  # its value is among the addresses
            found.functions.append((item, words("G")[item.address]))
        if item.assigned and item.address in _RADIUS:
            self._axis_or_address(found, "R", self._number(item), item)
            return
        if item.assigned and (match := _PARAMETER.fullmatch(item.address)):
            if not match["number"]:
                raise self._no_address(item.address, item.as_written, item.offset)
            found.assignments.append(
                Assign(self._parameter(match, item.offset), self._number(item))
            )
            return
        self._axis_or_address(found, item.address, self._number(item), item)

    def _opened(self, found: _Gathered, item: nodes.Opened) -> None:
        value = _single_value(item.bracket)
        if _DWELL.fullmatch(item.address) and value is not None:
            word = nodes.Word("G", "4", item.offset)
            found.functions.append((word, self._function(word)))
            self._dwell_time(found, value, item.offset)
        elif item.value is not None:
            if item.address not in ("P", "R") or value is None:
                raise self.source.error(
                    "a value is either in [ ] or after =, not in both",
                    item.offset,
                    value=item.address,
                )
            found.assignments.append(Assign(Variable(f"{item.address}[]", (value,)), item.value))
        elif value is not None:
            word = nodes.Word(item.address, value, item.offset)
            self._word(found, word)
        else:
            command = axis_command(self, item)
            found.axis_commands.append(command)

    def _dwell_time(self, found: _Gathered, value: Expression, offset: int) -> None:
        """G4 takes its time without an address. Source: programming manual 206132747."""
        if not found.functions or found.functions[-1][1].word != "G4":
            raise self.source.error(
                "a value needs an address before it",
                offset,
                value=self.source.found(offset),
                allowed="X10, F500; a time alone after G4",
            )
        if any(name == "G4" for name, _ in found.addresses):
            raise self.source.error("second time in one block", offset)
        found.addresses.append(("G4", value))

    def _jump(self, found: _Gathered, item: nodes.Jump) -> None:
        if found.goto is not None:
            raise self.source.error("second jump in one block", item.offset, value="$GOTO")
        found.goto = item.target

    def _axis_or_address(
        self, found: _Gathered, address: str, value: Expression, item: nodes.Word
    ) -> None:
        if isinstance(value, Text):
            raise self.source.error(
                f"{address} takes a number", item.offset, value=value.value, allowed="no text"
            )
        axis = self.axes.get(address)
        if axis is not None:
            if axis in found.axes:
                raise self.source.error("axis twice in one block", item.offset, value=axis)
            found.axes[axis] = value
            return
        word = words("address").get(address)
        if word is None or address == "N":
            raise self._no_address(address, item.as_written, item.offset)
        if any(name == address for name, _ in found.addresses):
            name = "feed" if address == "F" else address
            raise self.source.error(f"second {name} in one block", item.offset, value=address)
        if address == "F":
            self._check_feed(value, item.offset)
        if not word.acts:
            self.note(address, word.meaning, item.offset)
        found.addresses.append((address, value))

    def _words(self, found: _Gathered) -> Words:
        self._check_groups(found.functions)
        g = tuple(word.word for _, word in found.functions if word.kind == "G")
        m = tuple(word.word for _, word in found.functions if word.kind == "M")
        for item, word in found.functions:
            if word.word in NEEDS_AXES and not found.axes:
                raise self.source.error(
                    f"{word.word} needs an axis",
                    item.offset,
                    value=word.word,
                    allowed=[f"{axis}.." for axis in self.axes.values()],
                )
        return Words(
            g,
            m,
            tuple(found.axes.items()),
            tuple(found.addresses),
            tuple(found.axis_commands),
            found.goto,
        )

    def _function(self, item: nodes.Word) -> Word:
        """Find a G or M function; a leading zero of its number has no meaning."""
        digits = item.value if isinstance(item.value, str) else _whole_text(item.value)
        if digits is None or not _FUNCTION_NUMBER.fullmatch(digits) or item.assigned:
            raise self.source.error(
                f"{item.address} takes a whole number without sign",
                item.offset,
                value=item.as_written,
            )
        name = item.address + (digits.lstrip("0") or "0")
        word = words(item.address).get(name)
        if word is None and item.address == "M":
            # Every other number goes to the PLC side as it is (P-CHAN-00041)
            return Word(name, "M", "", True, "", "")
        if word is None and (row := published_g().get(name)) is not None:
            self.note(name, row.meaning, item.offset)
            return Word(name, "G", "", False, row.source, row.meaning)
        if word is None:
            names = [*words(item.address), *(published_g() if item.address == "G" else ())]
            raise self.unknown(f"{item.address} function", name, item.offset, names)
        if name in VALUED:
            what, written = VALUED[name]
            raise self.source.error(f"{name} needs a {what}", item.offset, allowed=written)
        if not word.acts:
            self.note(name, word.meaning, item.offset)
        return word

    def _check_feed(self, feed: Expression, offset: int) -> None:
        if isinstance(feed, Number) and feed.value <= 0:
            raise self.source.error(
                "feed must move the axes",
                offset,
                value=f"F{feed.value:g}",
                allowed="greater than 0 mm/min",
            )

    def _no_address(self, address: str, as_written: str, offset: int) -> Exception:
        if address == "N":
            return self.source.error(
                "a block number is only allowed at the beginning of its block",
                offset,
                value=as_written,
            )
        return self.source.error(
            "the rig has no such axis", offset, value=address, allowed=self.axes.values()
        )

    def _number(self, item: nodes.Word) -> Expression:
        if isinstance(item.value, str):
            return Number(self.digits(item.value, item.offset))
        return item.value

    def _parameter(self, match: re.Match[str], offset: int) -> Variable:
        return self.known(f"{match['sign']}[]", (Number(float(match["number"])),), offset)

    def _check_groups(self, functions: Sequence[tuple[nodes.Word, Word]]) -> None:
        by_group: dict[str, Word] = {}
        for item, word in functions:
            if word.group and word.group in by_group:
                raise self.source.error(
                    f"{by_group[word.group].word} and {word.word} exclude each other in one block",
                    item.offset,
                    value=word.word,
                    allowed=f"one word of the group '{word.group}'",
                )
            by_group[word.group] = word


def _g_name(item: nodes.Word) -> str | None:
    """Give the G function that a word is, `G128` of `G128 = 70` too; None for another word."""
    if item.address == "G" and isinstance(item.value, str) and item.value.isdigit():
        return f"G{item.value.lstrip('0') or '0'}"
    return item.address if item.assigned and item.address in published_g() else None


def _is_published(item: Any) -> bool:
    """Whether an item of a block is a G function that can only end the program."""
    name = _g_name(item) if isinstance(item, nodes.Word) else None
    row = None if name is None else published_g().get(name)
    return row is not None and not row.passed_over


_ITEMS = (nodes.Word, nodes.Opened, nodes.Setting, nodes.Jump, nodes.Lone)


def label_name(token: Token) -> str:
    """Give the name of a label in brackets as `Label` and `Target` have it."""
    return f"[{token[1:-1].strip()}]"


def _single_value(bracket: nodes.Bracket) -> Expression | None:
    """Give the expression of a bracket that holds one and nothing else."""
    if len(bracket.elements) == 1 and len(bracket.elements[0]) == 1:
        entry = bracket.elements[0][0]
        if entry.keyword is None and isinstance(entry.value, nodes.Value):
            return entry.value.expression
    return None


def _whole_text(value: Expression) -> str | None:
    if isinstance(value, Number) and value.value == int(value.value) and value.value >= 0:
        return str(int(value.value))
    return None
