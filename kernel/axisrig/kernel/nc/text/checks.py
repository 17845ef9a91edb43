"""What a # command may say that its table does not limit: constants that no machine could take."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc import message
from axisrig.kernel.nc.coordinates import MAIN_AXES
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.nc.syntax import Command, Group, Name, Number, Text, Variable
from axisrig.kernel.nc.text import distance, nodes
from axisrig.kernel.nc.text.values import ExpressionBuilder

PROBE_OF_AXIS = ("SIGNAL", "EDGE", "INPUT", "G107", "G108")
PROBE_OF_CHANNEL = ("SIMU_OFFSET", "TRIGGER")
KEY_LENGTH_MAX = 29  # P-AXIS-00396
COMPONENTS = 6  # of a coordinate system
_SERCOS = re.compile(r"[SsPp]-[0-9]-[0-9]{1,5}")
_WRITTEN = ("V.P.", "V.S.", "V.L.", "P[")  # what a value that is read may go to
_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")

# What the brackets of a #CS command hold, by their number. TF5200 programming manual 208480907
_SHIFTS, _ID, _NAMED = ("shifts",), ("ID", "shifts"), ("name", "shifts")
_BRACKETS: Mapping[str, Mapping[int, tuple[str, ...]]] = {
    "CS ON": {1: _SHIFTS, 2: _ID},
    "CS DEF": {1: _SHIFTS, 2: _ID},
    "CS ADD": {2: _NAMED},
    "CS SET": {2: _NAMED},
    "CS SELECT": {1: ("name",)},
}

# Keywords of which a command takes one; `ALL` is instead of a value. TF5200 programming manual
_ONE_OF: Mapping[str, tuple[str, ...]] = {
    "CHANNEL INIT": ("CMDPOS", "ACTPOS"),
    **dict.fromkeys(
        ("CONTOUR MODE", "CONTOUR MODE ON", "CONTOUR MODE OFF"),
        ("DEV", "DIST", "POS", "DIST_SOFT", "DIST_MASTER", "PTP"),
    ),
    **dict.fromkeys(("DISABLE AX LINK", "AX LINK OFF", "PUT AX", "WAIT INDP"), ("ALL",)),
}

Check = Callable[[ExpressionBuilder, Command, Mapping[str, int], nodes.RawCommand], Command]


def checked(
    builder: ExpressionBuilder,
    command: Command,
    places: Mapping[str, int],
    raw: nodes.RawCommand,
) -> Command:
    """Give the command back; places: where the value of each keyword is."""
    _check_one_of(builder, command, places)
    for start, check in _CHECKS.items():
        if command.name == start or command.name.startswith(f"{start} "):
            return check(builder, command, places, raw)
    return command


def _check_one_of(builder: ExpressionBuilder, command: Command, places: Mapping[str, int]) -> None:
    """Refuse a second keyword of those of which a command takes one, and `ALL` beside a value."""
    found = [word for word in places if word in _ONE_OF.get(command.name, ())]
    if len(found) > 1:
        both, wrong = f"{found[0]} and {found[1]}", found[1]
    elif found == ["ALL"] and command.arguments:
        both, wrong = "ALL and a value", "ALL"
    else:
        return
    message = f"{both} of #{command.name} exclude each other"
    raise builder.source.error(message, places[wrong], value=wrong, allowed="one of them")


def _wrong(builder: ExpressionBuilder, command: Command, offset: int, allowed: str) -> UserError:
    return builder.source.error(f"wrong values for #{command.name}", offset, allowed=allowed)


def _message(
    builder: ExpressionBuilder, command: Command, _: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    arguments = command.arguments
    if not arguments or not isinstance(arguments[0], Text) or None in arguments:
        raise _wrong(builder, command, raw.offset, '["text", value, ..]')
    for bracket in raw.brackets:
        _check_values(builder, f"#{command.name}", bracket)
    try:
        pieces = message.pieces_of(arguments[0].value)
        kinds = [
            None if isinstance(value, Variable) else isinstance(value, Text)
            for value in arguments[1:]
        ]
        message.check_arguments(pieces, kinds)
    except message.FormatError as fault:
        text_begin = builder.source.code.index('"', raw.offset) + 1
        raise builder.source.error(
            fault.message, text_begin + fault.position, value=fault.value, allowed=fault.allowed
        ) from None
    return command


def _measuring_mode(
    builder: ExpressionBuilder, command: Command, _: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    for chosen in command.arguments:
        if chosen is None:
            raise _wrong(builder, command, raw.offset, "[type] or nothing")
        if isinstance(chosen, Number) and chosen.value not in measuring_types():
            raise builder.source.error(
                "no such measuring type",
                raw.offset,
                value=f"{chosen.value:g}",
                allowed=measuring_types(),
            )
    return command


def _probe(
    builder: ExpressionBuilder, command: Command, _: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    """What belongs to an axis names one, and what belongs to the channel does not.

    Source: programming manual 207092107.
    """
    written = [keyword for keyword, _ in command.options]
    named = [word for word in written if word in ("AX", "AXNR")]
    of_axis = [word for word in written if word in PROBE_OF_AXIS]
    of_channel = [word for word in written if word in PROBE_OF_CHANNEL]
    edges = [word for word in written if word in ("G107", "G108")]
    both = [*of_channel[:1], *named, *of_axis] if of_channel else []
    for pair in (of_channel, both, named if command.name == "MEAS" else [], edges):
        if len(pair) > 1:
            raise builder.source.error(
                f"{pair[0]} and {pair[1]} of #{command.name} exclude each other",
                raw.offset,
                value=pair[1],
                allowed="one of them",
            )
    if command.name == "MEAS" and len(written) == len(named):
        raise builder.source.error(
            "#MEAS says nothing",
            raw.offset,
            value=named[0] if named else None,
            allowed="TYPE, ERR_NO_SIGNAL, or a setting of an axis beside AX or AXNR",
            hint="#MEAS DEFAULT goes back to what the lists say",
        )
    if not named and (of_axis or command.name == "MEAS PREPARE"):
        raise builder.source.error(
            f"#{command.name} names no axis",
            raw.offset,
            value=of_axis[0] if of_axis else None,
            allowed="AX=<name> or AXNR=<number>",
        )
    return command


def _system(
    builder: ExpressionBuilder, command: Command, _: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    if len(builder.axes) < MAIN_AXES and command.arguments:
        raise builder.source.error(
            "a coordinate system needs three main axes", raw.offset, value=", ".join(builder.axes)
        )
    for group in command.arguments:
        if not isinstance(group, Group):
            raise _wrong(builder, command, raw.offset, "brackets after it")
        strange = any(isinstance(argument, Text | Group) for argument in group.arguments)
        if len(group.arguments) > COMPONENTS or group.options or strange:
            raise _wrong(builder, command, raw.offset, "three shifts and three angles")
    held = _BRACKETS.get(command.name, {}).get(len(raw.brackets), ())
    for bracket, what in zip(raw.brackets, held, strict=False):
        if what != "shifts":
            _check_id(builder, command, bracket, what)
        elif command.name != "CS ON" or len(raw.brackets) > 1 or not _may_be_id(bracket):
            _check_values(builder, f"#{command.name}", bracket)
    return command


def _may_be_id(bracket: nodes.Bracket) -> bool:
    """Whether a bracket has one value, which of `#CS ON` may be the ID of a stored system."""
    return len(bracket.elements) <= 1 and all(len(element) <= 1 for element in bracket.elements)


def _check_id(
    builder: ExpressionBuilder, command: Command, bracket: nodes.Bracket, what: str
) -> None:
    """An ID is a number or a name; a letter O alone is a zero that was mistyped."""
    entries = [entry for element in bracket.elements for entry in element]
    value = entries[0].value if entries else None
    is_zero = isinstance(value, nodes.Bare) and value.text.upper() == "O" and what == "ID"
    if len(entries) > 1 or is_zero or (what == "name" and not entries):
        wrong = entries[1] if len(entries) > 1 else entries[0] if entries else bracket
        raise builder.source.error(
            f"the first bracket of #{command.name} takes one {what}",
            wrong.offset,
            value=builder.source.found(wrong.offset),
            allowed="a number from 1, or a name" if what == "ID" else "a name",
            hint="0 meant?" if is_zero else None,
        )


def _check_values(builder: ExpressionBuilder, shown: str, bracket: nodes.Bracket) -> None:
    """Refuse a name where a number belongs, and two values without a comma between them."""
    for element in bracket.elements:
        for place, entry in enumerate(element):
            found = builder.source.found(entry.offset)
            if place:
                raise builder.source.error(
                    "two values are separated by a comma",
                    entry.offset,
                    value=found,
                    allowed="comma",
                )
            if isinstance(entry.value, nodes.Bare):
                raise builder.source.error(
                    f"{shown} takes a number or an expression here",
                    entry.offset,
                    value=found,
                    allowed="10, P1, V.P.NAME, [P1+5]",
                    hint="0 meant?" if found.upper() == "O" else None,
                )


def _drive(
    builder: ExpressionBuilder, command: Command, places: Mapping[str, int], _: nodes.RawCommand
) -> Command:
    source, key = builder.source, command.option("KEY")
    if isinstance(key, Name) and (not _KEY.fullmatch(key.value) or len(key.value) > KEY_LENGTH_MAX):
        raise source.error(
            "KEY takes the name of one drive function",
            places["KEY"],
            value=key.value,
            allowed=f"letters, digits, _ and ., at most {KEY_LENGTH_MAX}",
        )
    value = command.option("VAL")
    if isinstance(value, Number) and value.value != round(value.value):
        raise source.error(
            "VAL takes a whole number",
            places["VAL"],
            value=f"{value.value:g}",
            hint="fractions come from scaling_factor of the function",
        )
    _check_result(builder, command, places)
    return command


def _check_result(builder: ExpressionBuilder, command: Command, places: Mapping[str, int]) -> None:
    variable = command.option("P")
    if isinstance(variable, Variable) and not variable.name.startswith(_WRITTEN):
        raise builder.source.error(
            "P takes the variable that gets the value",
            places["P"],
            value=variable.name,
            allowed="V.P.name, P1",
        )


def _ident(
    builder: ExpressionBuilder, command: Command, places: Mapping[str, int], _: nodes.RawCommand
) -> Command:
    """An ident is spelled as its drives spell it. Source: programming manual 207352971."""
    ident = command.option("ID")
    if isinstance(ident, Name):
        is_object = ident.value[:2].upper() == "0X"
        if not (is_object or _SERCOS.fullmatch(ident.value)) or (is_object and command.has("SERC")):
            raise builder.source.error(
                "ID takes the number of an ident",
                places["ID"],
                value=ident.value,
                allowed="S-0-0092, P-0-0129; 0x6072_00 with CAN",
            )
    _check_result(builder, command, places)
    return command


KINEMATIC_ID_MAX = 0xFFFF
"""P-CHAN-00262 is UNS16."""


def _kinematic(
    builder: ExpressionBuilder, command: Command, _: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    """`#KIN ID[9.98]` is printed for `#KIN ID[9,98]`: two kinematics, no number with a fraction.

    Raises UserError for brackets that name none, and for a number that no ID can be.
    """
    values = command.arguments
    large = [v for v in values if isinstance(v, Number) and v.value > KINEMATIC_ID_MAX]
    if large:
        raise builder.source.error(
            "no kinematic has such an ID",
            raw.offset,
            value=f"#{command.name} [{large[0].value:.17g}]",
            allowed=f"1 .. {KINEMATIC_ID_MAX} (P-CHAN-00262)",
        )
    if raw.brackets and not values:
        raise builder.source.error(
            "no kinematic is named",
            raw.offset,
            value=f"#{command.name} []",
            allowed=f"#{command.name} [9], #{command.name} [9, 98]",
        )
    if len(values) == 1 and isinstance(values[0], Number):
        whole, _point, fraction = repr(values[0].value).partition(".")
        if fraction.isdecimal() and int(fraction):  # `1.8e+19` has none
            remark = f"#{command.name}[{whole}.{fraction}] read as [{whole},{fraction}]"
            builder.remark(remark, raw.offset)
            meant = Number(float(whole)), Number(float(fraction))
            return replace(command, arguments=meant, remark=remark)
    return command


def _distance(
    builder: ExpressionBuilder, command: Command, places: Mapping[str, int], raw: nodes.RawCommand
) -> Command:
    written = [keyword for keyword, _ in command.options]
    shown, has_brackets = f"#{command.name}", bool(raw.brackets)
    distance.check(builder, shown, written, places, raw.offset, has_brackets=has_brackets)
    return command


_CHECKS: Mapping[str, Check] = {
    "MSG": _message,
    "MEAS MODE": _measuring_mode,
    "MEAS": _probe,
    "CS": _system,
    "DRIVE": _drive,
    "IDENT": _ident,
    "COMMAND": _ident,
    "KIN ID": _kinematic,
    "TRAFO": _kinematic,
    "TRAFO ON": _kinematic,
    "DIST CTRL": _distance,
}
