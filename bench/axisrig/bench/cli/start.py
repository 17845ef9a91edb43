"""The process of a command: its garbage and threads, and the list of commands in its help."""

import atexit
import gc
import os
import sys
from typing import Any

from typer.core import TyperGroup

SENTENCE_MAX = 200  # signs
GARBAGE_MIN = 100_000
"""So many new objects before it is looked for garbage among them."""


class Whole(TyperGroup):
    """Shows the first sentence of every command whole, where plain help would cut it."""

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
