"""From a # command, an axis command or a cycle call to a checked statement.

What each takes is in `commands.csv`; `keywords.py` reads what is in the brackets.
"""

from collections.abc import Mapping, Sequence
from functools import cache

from axisrig.kernel.errors import Guess, UserError, nearest
from axisrig.kernel.nc.syntax import AxisCommand, Command, Expression, Name, SubprogramCall
from axisrig.kernel.nc.text import checks, distance, nodes
from axisrig.kernel.nc.text.keywords import Form, group, read
from axisrig.kernel.nc.text.published import published
from axisrig.kernel.nc.text.values import ExpressionBuilder
from axisrig.kernel.nc.text.words import commands

_AXIS = "<axis>"
_CALL = "L CYCLE"


def hash_command(builder: ExpressionBuilder, raw: nodes.RawCommand) -> Command:
    """Make the statement of a # command; raises UserError for what it cannot take."""
    upper = tuple(word.upper() for word in raw.words)
    name, rest = _split_name(upper)
    if name is None:
        raise _unknown_command(builder, " ".join(upper), raw.offset)
    form = Form(builder, name, f"#{name}", commands()[name], raw.offset)
    if not form.own.acts:
        builder.note(form.shown, form.own.meaning, raw.offset)
    spoken = tuple(
        nodes.Entry(None, nodes.Bare(word, raw.offset), raw.offset) for word in raw.words[rest:]
    )
    _check_rest(form, upper[rest:], raw)
    elements: list[tuple[nodes.Entry, ...]] = [spoken] if spoken else []
    elements += raw.loose.elements if raw.loose else ()
    if form.own.kind == "group":
        form.arguments += [group(form, bracket) for bracket in raw.brackets]
    elif len(raw.brackets) > 1:
        raise form.wrong(f"wrong values for {form.shown}")
    else:
        for bracket in raw.brackets:
            elements += bracket.elements
            _check_not_empty(form, bracket)
    read(form, elements)
    return checks.checked(
        form.builder, Command(name, tuple(form.arguments), tuple(form.options)), form.places, raw
    )


def axis_command(builder: ExpressionBuilder, item: nodes.Opened) -> AxisCommand:
    """Make a command to a single axis; raises UserError for what it cannot take."""
    axis = builder.axes.get(item.address)
    if axis is None:
        raise builder.source.error(
            "the rig has no such axis",
            item.offset,
            value=item.address,
            allowed=builder.axes.values(),
        )
    elements = list(item.bracket.elements)
    known = {name[len(_AXIS) :]: name for name in commands() if name.startswith(_AXIS)}
    first = elements[0][0] if elements[0] else None
    written = first.value.text if first and isinstance(first.value, nodes.Bare) else None
    if first is not None and (first.keyword or written):
        _check_leads(builder, axis, (first.keyword or written or "").upper(), first.offset, known)
    if first is None or written is None:
        raise builder.source.error(
            f"a value or a command to axis {axis} is needed in the bracket",
            item.bracket.offset,
            value=f"{item.address}[",
            allowed=[f"{axis}[expression]", *(f"{axis}[{name} ..]" for name in known)],
        )
    name = next((known_name for known_name in known if known_name == written.upper()), None)
    if name is None:
        raise builder.unknown("command to an axis", written, first.offset, known)
    form = Form(builder, name, f"{axis}[{name}", commands()[known[name]], item.offset)
    if not form.own.acts:
        builder.note(f"{axis}[{name}]", form.own.meaning, item.offset)
    elements[0] = elements[0][1:]
    read(form, elements)
    if name == distance.NAME:
        keywords = [keyword for keyword, _ in form.options]
        distance.check(builder, form.shown, keywords, form.places, item.offset)
    return AxisCommand(axis, name, tuple(form.options), tuple(form.arguments))


def _check_leads(
    builder: ExpressionBuilder, axis: str, word: str, offset: int, known: Mapping[str, str]
) -> None:
    """Refuse a keyword before the only command that has it."""
    if word in known:
        return
    owners = [name for name, row in known.items() if word in commands()[row]]
    if len(owners) == 1:
        raise builder.source.error(
            f"{owners[0]} is written before its keywords",
            offset,
            value=word,
            allowed=f"{axis}[{owners[0]} {word} ..]",
        )


def cycle_call(builder: ExpressionBuilder, call: nodes.Call) -> SubprogramCall:
    """Make the call of a subprogram or a cycle."""
    scope = "local" if call.local else "global"
    if call.bracket is None:
        return SubprogramCall(call.name, scope)
    form = Form(builder, "CYCLE", _CALL, commands()[_CALL], call.offset)
    if not form.own.acts:
        builder.note(_CALL, form.own.meaning, call.offset)
    read(form, call.bracket.elements)
    name = next(value for keyword, value in form.options if keyword == "NAME")
    assert isinstance(name, Name)
    rest = tuple(option for option in form.options if option[0] != "NAME")
    for keyword, value in rest:
        if value is not None and not isinstance(value, Expression):
            place = form.places[keyword]
            raise form.wrong(
                f"{keyword} takes a number, a text or an expression",
                place,
                value=builder.source.found(place),
                allowed=f'{keyword}=10, {keyword}=P1, {keyword}="text"',
            )
    return SubprogramCall(name.value, "cycle", rest)


# ---- names


@cache
def _hash_names() -> tuple[str, ...]:
    """List the commands that are written with #."""
    return tuple(name for name in commands() if name != _CALL and not name.startswith(_AXIS))


def _split_name(words: Sequence[str]) -> tuple[str | None, int]:
    """Find the longest # command that the words begin with; how many words it has."""
    for count in range(len(words), 0, -1):
        name = " ".join(words[:count])
        if name in _hash_names():
            return name, count
    return None, 0


def _nearest(name: str) -> Guess:
    listed = (word[1:] for word in published() if word[0] == "#")
    return nearest(name, [*_hash_names(), *listed])


def _unknown_command(builder: ExpressionBuilder, name: str, offset: int) -> UserError:
    if f"{name} ".startswith(f"{_CALL} "):
        form = f"a call of a cycle has no #: {_CALL} [NAME=..]"
        return builder.source.error("unknown # command", offset, value=f"#{name}", hint=form)
    first = name.partition(" ")[0]
    same = [f"#{other}" for other in _hash_names() if other.partition(" ")[0] == first]
    close = [] if same and name == first else _nearest(name)
    hint = f"nearest: {', '.join('#' + other for other in close)}" if close else None
    return builder.source.error(
        "unknown # command",
        offset,
        value=f"#{name}",
        allowed=None if close else same or None,
        hint=hint or (None if same else "`axisrig language` lists them all"),
    )


def _check_rest(form: Form, rest: Sequence[str], raw: nodes.RawCommand) -> None:
    """Refuse words after the name that neither are keywords nor values of the command.

    Where another command looks more like it, that one is meant, else the form of this one is said.
    """
    if not rest or form.own.kind in ("name", "axis", "any"):
        return
    strange = next((word for word in rest if word not in form.table), None)
    if strange is None:
        return
    name = " ".join(word.upper() for word in raw.words)
    if _nearest(name)[:1] in ([], [form.name]):
        raise form.wrong(f"this does not belong after {form.shown}", raw.offset, value=strange)
    raise _unknown_command(form.builder, name, raw.offset)


def _check_not_empty(form: Form, bracket: nodes.Bracket) -> None:
    if not any(bracket.elements) and len(bracket.elements) == 1 and form.own.kind != "none":
        least = (form.own.allowed or "0").partition("-")[0]
        if least != "0":
            raise form.wrong(f"wrong values for {form.shown}")
