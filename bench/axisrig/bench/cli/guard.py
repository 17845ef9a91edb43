"""A watch over readers of other makers that could stand still in a damaged file."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final, Protocol

from axisrig.kernel.errors import UserError

CPU_S: Final = 10.0
"""Time of this process, not of the clock: a busy machine does not count."""


class Place(Protocol):
    """Something that goes on: its place changes."""

    @property
    def place(self) -> tuple[int, int]:
        """Where it is."""


@contextmanager
def needs_progress(progress: Place, file: Path, cpu_s: float = CPU_S) -> Iterator[None]:
    """End what runs inside when `progress` is where it was `cpu_s` seconds of computing before.

    Without timers of Unix, and outside the main thread, it watches nothing.
    Raises UserError with the name of the file.
    """
    last = progress.place

    def look(*_: object) -> None:
        nonlocal last
        before, last = last, progress.place
        if last == before:
            raise UserError(
                f"the reader of this kind of file stands still, {last[0]} frames and {last[1]}"
                f" bytes into it, for {cpu_s:g} s: the log is damaged, or no such file",
                file=file,
            )

    try:
        handler = signal.signal(signal.SIGVTALRM, look)
    except (AttributeError, ValueError):
        yield
        return
    signal.setitimer(signal.ITIMER_VIRTUAL, cpu_s, cpu_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, handler)
