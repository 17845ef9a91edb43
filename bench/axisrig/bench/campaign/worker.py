"""What goes on in a process apart: it does what is ordered, and ends with its parent."""

import faulthandler
import gc
import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from axisrig.bench.campaign.channel import ChannelError, send
from axisrig.bench.files import DISK_FULL
from axisrig.bench.rig.fmu_output import divert
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.cosim.fmi.session import share_session_folder

_PR_SET_PDEATHSIG = 1  # Linux, prctl(2)


class Line(NamedTuple):
    """A line for standard output."""

    text: str


class Answer(NamedTuple):
    """What the function returned, or raised.

    lowered: limits of the process that were lowered meanwhile, where it raised for a full disk.
    """

    value: Any
    error: Exception | None = None
    lowered: str = ""


class Order(NamedTuple):
    """What a process is to do next; note: where it writes what it does."""

    note: Path
    function: Callable[..., Any]
    arguments: Sequence[Any]


_ANSWERS: list[Connection] = []

PARENT_ENDS: set[Connection] = set()
"""The ends of channels that this process holds as a parent. A process that is forked from it has
them too: it lets go of them, or its own channel would never end, and foreign code in it could write
orders to others."""


def say(text: str) -> None:
    """Put a line out on standard output; in a process apart, on that of who started it."""
    if _ANSWERS:
        send(_ANSWERS[0], Line(text))
    else:
        print(text, flush=True)


def end_with(parent: int) -> None:
    """End this process when the one with this id ends, however that ends.

    On Linux at once; elsewhere it is asked only here, and a worker ends when its channel does.
    """
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.name == "posix" and os.getppid() != parent:
        os._exit(1)


def work(pipe: Connection, folder: Path, parent: int) -> None:
    """Do what is ordered until nobody is there any more. parent: id of the process that orders."""
    for end in PARENT_ENDS:
        end.close()
    PARENT_ENDS.clear()
    end_with(parent)
    # How it dies is reported from outside, with the name of the FMU; a stack of Python says nothing
    faulthandler.disable()
    # Ctrl-C reaches every process of a terminal; the one that watches ends this one
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # The command line's handler would wait for a call that never comes back
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    share_session_folder(folder)
    gc.freeze()  # what came with the process stays: it is not looked through for garbage
    _ANSWERS[:] = [pipe]
    try:
        while True:
            _answer(pipe, pipe.recv())
    except (EOFError, OSError):
        os._exit(1)  # without the exit handlers of foreign libraries


def output_of(note: Path) -> Path:
    """Return the file that takes the standard output of an order."""
    return note.with_suffix(".out")


def _answer(pipe: Connection, order: Order) -> None:
    before = _limits()
    journal.begin(order.note)
    divert(output_of(order.note))
    try:
        answer = Answer(order.function(*order.arguments))
    except Exception as error:
        is_full = isinstance(error, OSError) and error.errno in DISK_FULL
        answer = Answer(None, _portable(error), _lowered(before) if is_full else "")
    try:
        send(pipe, answer)
    except OSError:
        raise
    except Exception as error:
        send(pipe, Answer(None, _portable(error)))


def _limits() -> Mapping[str, int]:
    """Limits of this process that the system sets, by their name; none where it has no such."""
    try:
        import resource  # noqa: PLC0415 - not on Windows
    except ImportError:
        return {}
    names = [name for name in dir(resource) if name.startswith("RLIMIT_")]
    found = {name: resource.getrlimit(getattr(resource, name))[0] for name in names}
    return {n: sys.maxsize if s == resource.RLIM_INFINITY else s for n, s in found.items()}


def _lowered(before: Mapping[str, int]) -> str:
    now = _limits()
    return ", ".join(f"{name} to {now[name]}" for name in before if now[name] < before[name])


def _portable(error: Exception) -> Exception:
    """Return an exception that can be raised in another process, with the stack of this one."""
    stack = "".join(traceback.format_exception(error))
    if isinstance(error, ChannelError):
        return RuntimeError(str(error))
    try:
        error.add_note(stack)
        pickle.loads(pickle.dumps(error))
        return error
    except Exception:
        return RuntimeError(stack)
