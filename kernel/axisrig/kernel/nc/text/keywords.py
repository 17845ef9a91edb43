"""The brackets of commands: keywords and values, checked against `commands.csv`.

Between a keyword and its value is `=` or a blank, or nothing before a number (`POS100`).
Source: TF5200 programming manual 207365515 (drive idents), 208612235 (independent axes).
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.syntax import Argument, Group, Name, Number, Option, Text, Variable
from axisrig.kernel.nc.text import nodes
from axisrig.kernel.nc.text.values import ExpressionBuilder
from axisrig.kernel.nc.text.words import Keyword

_JOINED_NUMBER = re.compile(r"(?P<word>[A-Za-z_]+)(?P<digits>[0-9]+(?:\.[0-9]*)?)")
_FUNCTION = re.compile(r"([GM])0*([0-9]+)")


@dataclass
class Form:
    """A command being read: its rows of the table, what has been found so far."""

    builder: ExpressionBuilder
    name: str
    shown: str
    table: Mapping[str, Keyword]
    offset: int
    arguments: list[Argument] = field(default_factory=list)
    options: list[tuple[str, Option]] = field(default_factory=list)
    places: dict[str, int] = field(default_factory=dict)

    @property
    def own(self) -> Keyword:
        """The row of the command itself."""
        return self.table[""]

    def shape(self) -> str:
        """Say what is allowed in the command."""
        parts = []
        if self.own.kind != "none":
            parts.append(f"{self.own.kind} ({self.own.allowed or 'any number'})")
        for keyword, row in self.table.items():
            if keyword:
                text = keyword if row.kind == "flag" else f"{keyword}={_shown_kind(row)}"
                parts.append(text if row.required == "yes" else f"({text})")
        if not parts:
            return "nothing after it"
        opening = self.shown if "[" in self.shown else f"{self.shown} ["
        return f"{opening} {' '.join(parts)}], what is in ( ) may be left out".replace("[ ", "[")

    def wrong(self, message: str, offset: int | None = None, **details: object) -> UserError:
        """Make an error of this command; what is allowed is added unless `details` has it."""
        details.setdefault("allowed", self.shape())
        place = self.offset if offset is None else offset
        return self.builder.source.error(message, place, **details)  # type: ignore[arg-type]


def read(form: Form, elements: Iterable[tuple[nodes.Entry, ...]]) -> None:
    """Read what is in the bracket of a command; raises UserError for what it cannot take."""
    elements = list(elements)
    gaps = len(elements) > 1
    for element in elements:
        if not element and gaps:
            if form.own.kind in ("none", "flag"):
                continue
            form.arguments.append(None)
        entries, before = iter(element), len(form.arguments)
        for entry in entries:
            _entry(form, entry, entries)
            if len(form.arguments) > before + 1:
                raise form.wrong(
                    "two values are separated by a comma",
                    entry.offset,
                    value=form.builder.source.found(entry.offset),
                    allowed="comma",
                )
    _check_number(form)
    _check_required(form)


def _entry(form: Form, entry: nodes.Entry, following: Iterator[nodes.Entry]) -> None:
    if entry.keyword is not None:
        row = _row(form, entry.keyword)
        if row is None:
            raise _unknown_keyword(form, entry.keyword, entry.offset, has_value=True)
        if row.kind == "flag":
            raise form.wrong(f"{entry.keyword} takes no value", entry.offset, value=entry.keyword)
        _option(form, row, entry.keyword, entry.value, entry.offset)
        return
    if isinstance(entry.value, nodes.Bare):
        _bare(form, entry.value, following)
    else:
        _positional(form, entry)


def _bare(form: Form, bare: nodes.Bare, following: Iterator[nodes.Entry]) -> None:
    """A word without `=`: a flag, a keyword whose value follows or is joined, or a value."""
    word = _FUNCTION.sub(r"\1\2", bare.text.upper()) if _is_function(bare) else bare.text.upper()
    row = _row(form, word)
    if row is not None and row.kind == "flag":
        _note_option(form, row, word, bare.offset)
        form.options.append((word, None))
        form.places.setdefault(word, bare.offset)
        return
    if row is not None:
        entry = next(following, None)
        if entry is None or entry.keyword is not None:
            raise form.wrong(f"{word} has no value", bare.offset, value=word)
        _option(form, row, word, entry.value, bare.offset)
        return
    joined = _JOINED_NUMBER.fullmatch(bare.text)
    row = _row(form, joined["word"].upper()) if joined else None
    if joined and row is not None and row.kind == "expression":
        place = bare.offset + len(joined["word"])
        number = Number(form.builder.digits(joined["digits"], place))
        _option(form, row, row.keyword, nodes.Value(number, place), bare.offset)
        return
    _positional(form, nodes.Entry(None, bare, bare.offset))


def _is_function(bare: nodes.Bare) -> bool:
    return _FUNCTION.fullmatch(bare.text.upper()) is not None


def _row(form: Form, keyword: str) -> Keyword | None:
    """Find a keyword in the table; `@P*` means @P1, @P2 and so on, `M*` for M functions."""
    row = form.table.get(keyword) if keyword else None
    stem = keyword.rstrip("0123456789")
    return row or (form.table.get(f"{stem}*") if stem != keyword else None)


def _option(
    form: Form,
    row: Keyword,
    keyword: str,
    value: nodes.Value | nodes.Bare | nodes.Bracket,
    offset: int,
) -> None:
    if row.keyword.endswith("*"):  # @P01 is @P1
        stem = row.keyword[:-1]
        keyword = f"{stem}{int(keyword[len(stem) :])}"
    if keyword in form.places and (row.required != "many" or row.keyword.endswith("*")):
        raise form.wrong("keyword twice in one command", offset, value=keyword)
    _note_option(form, row, keyword, offset)
    form.places[keyword] = value.offset
    form.options.append((keyword, _taken(form, row, keyword, value)))


def _note_option(form: Form, row: Keyword, keyword: str, offset: int) -> None:
    if form.own.acts and not row.acts:
        form.builder.note(f"{form.shown} [{keyword}]", row.meaning, offset)


def _taken(
    form: Form, row: Keyword, keyword: str, value: nodes.Value | nodes.Bare | nodes.Bracket
) -> Option:
    """Check the kind of a value; raises UserError for one that does not fit."""
    wrong = form.wrong(
        f"{keyword} takes {_KINDS[row.kind]}",
        value.offset,
        value=form.builder.source.found(value.offset),
        allowed=", ".join(row.allowed.split()) or f"{keyword}={_shown_kind(row)}",
    )
    match row.kind, value:
        case "expression", nodes.Value(expression) if not isinstance(expression, Text):
            _check_range(form, row, keyword, nodes.Value(expression, value.offset))
            return expression
        case ("text", nodes.Value(Text() as found)) | (
            "variable",
            nodes.Value(Variable() as found),
        ):
            return found
        case (("axis" | "name" | "ident"), nodes.Bare()):
            return _name(form, row, keyword, value)
        case "any", _:
            return _any(form, value)
        case _:
            raise wrong


def _name(form: Form, row: Keyword, keyword: str, value: nodes.Bare) -> Name:
    """Check a plain word: an axis of the rig, one of the names that are allowed, or any name."""
    if row.kind == "ident":
        return Name(value.text)
    upper, axes = value.text.upper(), form.builder.axes
    if row.kind == "axis":
        if upper not in axes:
            raise form.wrong(
                "the rig has no such axis", value.offset, value=value.text, allowed=axes.values()
            )
        return Name(axes[upper])
    names = row.allowed.split()
    if names and upper not in names:
        close = nearest(upper, names)
        raise form.wrong(
            f"{keyword} takes {_KINDS[row.kind]}",
            value.offset,
            value=value.text,
            allowed=names,
            hint=f"nearest: {', '.join(close)}" if close else None,
        )
    return Name(upper)


def _check_range(form: Form, row: Keyword, keyword: str, value: nodes.Value) -> None:
    """Check a constant against `0..1` or a list of numbers."""
    if not row.allowed or not isinstance(value.expression, Number):
        return
    number = value.expression.value
    low, between, high = row.allowed.partition("..")
    fits = (
        (not low or number >= float(low)) and (not high or number <= float(high))
        if between
        else number in [float(text) for text in row.allowed.split()]
    )
    if not fits:
        raise form.wrong(
            f"{keyword} out of range", value.offset, value=f"{number:g}", allowed=row.allowed
        )


def _positional(form: Form, entry: nodes.Entry) -> None:
    kind, value = form.own.kind, entry.value
    match kind, value:
        case (("expression" | "any" | "text"), nodes.Value(expression)):
            if kind == "expression" and isinstance(expression, Text):
                raise form.wrong(f"wrong values for {form.shown}")
            form.arguments.append(expression)
        case (("name" | "axis"), nodes.Bare(text)):
            row = Keyword("", "value", kind, "", "", True, "", "")
            form.arguments.append(_taken(form, row, "value", value))
        case "variable", nodes.Value(Variable() as variable):
            form.arguments.append(variable)
        case (("any" | "group"), _):
            form.arguments.append(_any(form, value))
        case _, nodes.Bare(text):
            raise _unknown_keyword(form, text, entry.offset)
        case _:
            raise form.wrong(f"wrong values for {form.shown}")


def _any(form: Form, value: nodes.Value | nodes.Bare | nodes.Bracket) -> Argument:
    if isinstance(value, nodes.Value):
        return value.expression
    if isinstance(value, nodes.Bare):
        return Name(form.builder.axes.get(value.text.upper(), value.text.upper()))
    return group(form, value)


def group(form: Form, bracket: nodes.Bracket) -> Group:
    """Values in brackets of their own."""
    arguments: list[Argument] = []
    options: list[tuple[str, Option]] = []
    for element in bracket.elements:
        if not element:
            arguments.append(None)
        for entry in element:
            if entry.keyword is None:
                arguments.append(_any(form, entry.value))
            else:
                options.append((entry.keyword, _any(form, entry.value)))
    return Group(tuple(arguments), tuple(options))


def _unknown_keyword(form: Form, word: str, offset: int, *, has_value: bool = False) -> UserError:
    """Make the error of a word that is not in the command; it may be half of a name with `_`."""
    known = [keyword for keyword in form.table if keyword]
    if not known and form.own.kind in _KINDS:
        return form.wrong(
            f"{form.shown} takes {_KINDS[form.own.kind]}",
            offset,
            value=word,
            allowed="10, P1, V.P.NAME" if form.own.kind == "expression" else form.shape(),
            hint="0 meant?" if word.upper() == "O" else None,
        )
    hint, close = None, nearest(word.upper(), known)
    if not (has_value and close) and (name := _name_with(form, word)) is not None:
        hint = f"names have no blanks: {name}?"
    elif close:
        hint = f"nearest: {', '.join(close)}"
    return form.wrong(
        f"unknown keyword of {form.shown}", offset, value=word, allowed=known, hint=hint
    )


def _name_with(form: Form, word: str) -> str | None:
    """Give the name that the word at hand goes on with; None where it can be none.

    An axis goes on with no word, and one of several names only with what makes another of them.
    """
    keyword, value = form.options[-1] if form.options else ("", None)
    row = _row(form, keyword)
    if not isinstance(value, Name) or (row is not None and row.kind == "axis"):
        return None
    name = f"{value.value}_{word}"
    names = row.allowed.split() if row is not None else []
    return name if not names or name.upper() in names else None


def _check_number(form: Form) -> None:
    least, to, most = form.own.allowed.partition("-")
    if form.own.kind == "none" or not form.own.allowed:
        return
    upper = float("inf") if to and not most else float(most or least)
    if not float(least) <= len(form.arguments) <= upper:
        raise form.wrong(f"wrong values for {form.shown}")


def _check_required(form: Form) -> None:
    shared: dict[str, list[str]] = {}
    for keyword, row in form.table.items():
        if keyword and row.required not in ("no", "many", ""):
            shared.setdefault(keyword if row.required == "yes" else row.required, []).append(
                keyword
            )
    lacking = [
        " or ".join(keywords)
        for keywords in shared.values()
        if not any(keyword in form.places for keyword in keywords)
    ]
    if lacking and form.options:
        shown = f"{form.shown} ..]" if "[" in form.shown else form.shown
        raise form.wrong(f"{shown} lacks {' and '.join(lacking)}")
    if lacking and form.own.required == "yes":
        raise form.wrong(f"{form.shown} needs its keywords in one bracket")


_KINDS = {
    "expression": "a number or an expression",
    "name": "a name",
    "ident": "a name",
    "axis": "an axis of the rig",
    "variable": "a variable",
    "text": 'a text in "',
    "any": "a value",
}


def _shown_kind(row: Keyword) -> str:
    shown = {"expression": "number", "ident": "name", "variable": "variable"}
    return (
        "|".join(row.allowed.split())
        if row.kind == "name" and row.allowed
        else shown.get(row.kind, row.kind)
    )
