"""From the # commands of a block to checked statements."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from kernel.errors import UserError
from kernel.nc import message
from kernel.nc.coordinates import MAIN_AXES
from kernel.nc.measuring_types import measuring_types
from kernel.nc.syntax import (
    Expression,
    MeasuringMode,
    MessageOut,
    Number,
    Statement,
    SystemOff,
    SystemOn,
    Text,
)
from kernel.nc.text.source import Source
from kernel.nc.text.words import Word

COMPONENTS = 6

Argument = Expression | Text | None


@dataclass(frozen=True)
class CommandText:
    """A # command as written: its name, the values of each bracket, its place; and the rig's axes.

    A value is None where the program leaves a gap between commas.
    """

    source: Source
    axes: tuple[str, ...]
    name: str
    brackets: tuple[tuple[Argument, ...], ...]
    offset: int

    def wrong(self, allowed: str, hint: str | None = None) -> UserError:
        """Make the error of values that do not fit the command."""
        return self.source.error(
            f"wrong values for #{self.name}", self.offset, allowed=allowed, hint=hint
        )

    def numbers(self, allowed: str, most: int) -> list[Expression | None]:
        """Give the values of the one bracket the command has; raises UserError otherwise."""
        if len(self.brackets) != 1 or len(self.brackets[0]) > most:
            raise self.wrong(allowed)
        values: list[Expression | None] = [
            value for value in self.brackets[0] if not isinstance(value, Text)
        ]
        if len(values) != len(self.brackets[0]):
            raise self.wrong(allowed)
        return values


def command_name(written: str) -> str:
    """Give the words of a # command in upper case with one blank between them."""
    return " ".join(written[1:].upper().split())


def not_acting(source: Source, offset: int, shown: str, word: Word) -> UserError:
    """Make the error of a word that the manuals know and this version does not carry out."""
    return source.error(
        f"known to the manuals but not acting yet ({word.meaning})", offset, value=shown
    )


def is_measuring_type(value: float) -> bool:
    """Tell whether a number is one of the measuring types. Source: FCT-C4 section 3."""
    return value in measuring_types()


def command_statement(given: CommandText) -> Statement:
    """Make the statement of a command that acts; raises UserError for values it cannot take."""
    return _HANDLERS[given.name](given)


def _measuring_mode(given: CommandText) -> MeasuringMode:
    if not given.brackets:
        return MeasuringMode(None)
    (chosen,) = given.numbers("[type] or nothing", 1)
    if chosen is None:
        raise given.wrong("[type] or nothing")
    if isinstance(chosen, Number) and not is_measuring_type(chosen.value):
        raise given.source.error(
            "no such measuring type",
            given.offset,
            value=f"{chosen.value:g}",
            allowed=measuring_types(),
        )
    return MeasuringMode(chosen)


def _system_on(given: CommandText) -> SystemOn:
    allowed = "[v1,v2,v3,a1,a2,a3], from two values on"
    if len(given.brackets) != 1 or len(given.brackets[0]) == 1:
        # One value alone is the number of a stored system. Source: programming manual, #CS.
        raise given.wrong(allowed, hint="stored coordinate systems are not acting yet")
    values = given.numbers(allowed, COMPONENTS)
    if len(given.axes) < MAIN_AXES:
        raise given.source.error(
            "a coordinate system needs three main axes",
            given.offset,
            value=", ".join(given.axes),
        )
    filled = [Number(0.0) if value is None else value for value in values]
    return SystemOn((*filled, *[Number(0.0)] * (COMPONENTS - len(filled))))


def _system_off(given: CommandText) -> SystemOff:
    if given.brackets:
        raise given.wrong("nothing behind it")
    return SystemOff(all_systems=given.name == "CS OFF ALL")


def _message(given: CommandText) -> MessageOut:
    arguments = given.brackets[0] if len(given.brackets) == 1 else ()
    if not arguments or not isinstance(arguments[0], Text) or None in arguments:
        raise given.wrong('["text", value, ..]')
    values = [value for value in arguments[1:] if value is not None]
    try:
        pieces = message.pieces_of(arguments[0].value)
        message.check_arguments(pieces, [isinstance(value, Text) for value in values])
    except message.FormatError as fault:
        text_begin = given.source.code.index('"', given.offset) + 1
        raise given.source.error(
            fault.message, text_begin + fault.position, value=fault.value, allowed=fault.allowed
        ) from None
    return MessageOut(pieces, tuple(values), synchronous=given.name == "MSG SYN")


_HANDLERS: Mapping[str, Callable[[CommandText], Statement]] = {
    "MEAS MODE": _measuring_mode,
    "CS ON": _system_on,
    "CS OFF": _system_off,
    "CS OFF ALL": _system_off,
    "MSG": _message,
    "MSG SYN": _message,
}
