"""The process of a command: garbage, threads, signals, and the list of commands in its help."""

import atexit
import codecs
import gc
import os
import re
import signal
import sys
from typing import Any

from typer.core import TyperGroup

SENTENCE_MAX = 200  # signs
GARBAGE_MIN = 100_000
"""So many new objects before it is looked for garbage among them."""


_TYPE = re.compile(r" ?<(?P<name>[^<>]+)>")
_WORDS = {"path": "PATH", "file": "PATH", "str": "TEXT", "int": "N", "float": "NUMBER"}
"""Types of options -> what help says for them."""


def _in_words(found: re.Match[str]) -> str:
    """Write the type of an option in words; choices stay, and what is a list is no matter."""
    inside = found["name"].removeprefix("list[").removesuffix("]").removesuffix(" range")
    return f" {_WORDS.get(inside.lower(), inside)}"


def _plain_context(of: Any) -> Any:
    """Return a class of contexts whose help has no types of Python."""

    class Formatter(of.formatter_class):  # type: ignore[misc]
        def write_dl(self, rows: Any, **how: Any) -> None:
            """Write a list of options or arguments: an argument has its name alone."""
            plain = [
                (_TYPE.sub(_in_words if name.startswith("-") else "", name), text)
                for name, text in rows
            ]
            super().write_dl(plain, **how)

    return type("PlainContext", (of,), {"formatter_class": Formatter})


class Whole(TyperGroup):
    """Shows the first sentence of every command whole, where plain help would cut it.

    Its commands have no types of Python in their help.
    """

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command, None for another word."""
        command = super().get_command(ctx, cmd_name)
        if command is not None and command.context_class is type(command).context_class:
            command.context_class = _plain_context(command.context_class)
        return command

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of commands."""
        names = {name: self.get_command(ctx, name) for name in self.list_commands(ctx)}
        rows = [(n, c.get_short_help_str(limit=SENTENCE_MAX)) for n, c in names.items() if c]
        with formatter.section("Commands"):
            formatter.write_dl(rows)


def start_lightly() -> None:
    """Set up a process that is to end soon: a fifth of a short command went into the garbage."""
    # Modules, tables and parsers stay, so that looking through them finds nothing
    gc.set_threshold(GARBAGE_MIN)
    atexit.register(gc.freeze)
    # python-can would import it for bus logs of its own, for more than half a second
    sys.modules.setdefault("asammdf", None)  # type: ignore[arg-type]
    # numpy would start a thread for each core
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


_PLAIN = {
    "✔": "+", "✖": "x", "■": "#", "≤": "<=", "≥": ">=", "≠": "!=", "±": "+-", "µ": "u", "°": "deg",
    "²": "2", "·": "*", "…": "...", "–": "-", "−": "-", "→": "->", "×": "x",
}  # fmt: skip
"""Signs that we print -> what a console shows that lacks them; `?` is a verdict of its own."""


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    signs = error.object[error.start : error.end]
    return "".join(_PLAIN.get(sign, "_") for sign in signs), error.end


def plain_signs() -> str:
    """Return the name of what writes signs that a console lacks in ASCII."""
    codecs.register_error("axisrig", _plain)
    return "axisrig"


_AGAIN_S = 0.02


def end_on_signals() -> None:
    """Let SIGTERM end the command as Ctrl-C does, wherever in the process it comes.

    An exception in a finaliser, or in a function that a library in C calls, is dropped by Python:
    one of these two is raised once more, until somebody takes it.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if hasattr(signal, "setitimer") and not isinstance(sys.unraisablehook, _RaiseAgain):
        sys.unraisablehook = _RaiseAgain(sys.unraisablehook)


class _RaiseAgain:
    """What Python calls for an exception that it drops."""

    def __init__(self, before: Any) -> None:
        self._before = before

    def __call__(self, dropped: Any) -> None:
        if issubclass(dropped.exc_type, KeyboardInterrupt):
            signal.signal(signal.SIGALRM, signal.default_int_handler)
            signal.setitimer(signal.ITIMER_REAL, _AGAIN_S)
        else:
            self._before(dropped)
