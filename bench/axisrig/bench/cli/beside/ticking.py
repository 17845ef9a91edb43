"""A thread that lets something say how far it is, however long a part of it takes."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from threading import Event, Lock, Thread
from typing import Protocol

TICK_S = 0.1
SWITCH_S = 1e-4
"""So long the thread of the runs waits for one of those beside it, at most: the 5 ms that Python
takes otherwise would make SYNCs late in real time."""
# Held while the thread prints and while a process is forked: a child that is forked in the middle
# of a print would find the locks of the stream held for ever
_FORKS = Lock()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(
        before=_FORKS.acquire, after_in_parent=_FORKS.release, after_in_child=_FORKS.release
    )


class Ticked(Protocol):
    """What says something once in a while."""

    def tick(self) -> None:
        """Say it, where that is due."""


def _tick(progress: Ticked) -> None:
    with _FORKS, suppress(OSError):  # a reader that has gone is met by the runs themselves
        progress.tick()


@contextmanager
def _every(period_s: float, do: Callable[[], None]) -> Iterator[None]:
    """Call a function again and again, from a thread of its own."""
    end = Event()

    def go_on() -> None:
        while not end.wait(period_s):
            do()

    thread = Thread(target=go_on, daemon=True, name="progress")
    thread.start()
    try:
        yield
    finally:
        end.set()
        thread.join()


@contextmanager
def ticking(progress: Ticked) -> Iterator[None]:
    """Say once in a while how far something is."""
    before_s = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    try:
        with _every(TICK_S, partial(_tick, progress)):
            yield
    finally:
        sys.setswitchinterval(before_s)
