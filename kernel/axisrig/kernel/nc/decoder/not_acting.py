"""What of the tables of the language somebody carries out, and what ends with alarm 900100."""

from collections.abc import Iterator
from dataclasses import dataclass

from axisrig.kernel.nc.decoder import registry
from axisrig.kernel.nc.decoder.topics import technology
from axisrig.kernel.nc.expressions import FUNCTIONS
from axisrig.kernel.nc.text.words import commands, variables, words

# They shape the text: the rooms of the text carry them out
_LETTERS = "GMNPLV"
_COMMANDS = ("COMMENT BEGIN", "COMMENT END", "L CYCLE")
_AXIS = "<axis>"


@dataclass(frozen=True)
class Entry:
    """A word, a command or a variable of a table.

    word: as a program has it. acts: what the table says. is_handled: whether somebody carries it
    out.
    """

    word: str
    table: str
    acts: bool
    is_handled: bool


def known() -> tuple[Entry, ...]:
    """Give every word, command and variable that the tables have."""
    return (*_words(), *_commands(), *_variables())


def _words() -> Iterator[Entry]:
    for kind, handled in (
        ("G", {*registry.SETTINGS, *registry.TAKES_AXES}),
        # What has no meaning of its own is sent to the PLC side
        ("M", words("M").keys() - technology.SPINDLE),
        ("address", {*registry.ADDRESSES, *registry.READ_ADDRESSES, *_LETTERS}),
        ("function", {*FUNCTIONS, "NOT"}),
    ):
        for word, row in words(kind).items():
            yield Entry(word, "words.csv", row.acts, word in handled)


def _commands() -> Iterator[Entry]:
    for name, keywords in commands().items():
        acts = keywords[""].acts
        if name.startswith(_AXIS):
            word = name.removeprefix(_AXIS)
            is_handled = word in registry.AXIS_COMMANDS
            yield Entry(f"{_AXIS}[{word}]", "commands.csv", acts, is_handled)
        else:
            is_handled = name in registry.COMMANDS or name in _COMMANDS
            yield Entry(f"#{name}", "commands.csv", acts, is_handled)


def _variables() -> Iterator[Entry]:
    for row in variables():
        yield Entry(row.name, "variables.csv", row.acts, registry.is_read(row.name))
