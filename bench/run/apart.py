"""Runs functions that call foreign code in processes of their own, and says how one died.

A crash (or an FMU that ends the process) costs one result, a call that never comes back is ended.
What the process was in the middle of is read from its journal (kernel/cosim/journal.py).
"""

import faulthandler
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from concurrent.futures import TimeoutError as PoolTimeout
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, TypeVar

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from kernel.cosim import journal
from kernel.cosim.archive import session_folder, share_session_folder
from kernel.errors import UserError

T = TypeVar("T")

CALL_LIMIT_S = 60.0
_LOOK_S = 0.25  # how often the parent looks at the journals
_HINTS = {
    "SIGSEGV": "it reached for memory that is not its own",
    "SIGBUS": "it reached for memory that is not its own",
    "SIGABRT": "it gave up: abort(), a failed assertion, or a damaged heap",
    "SIGFPE": "an integer division by zero",
    "SIGILL": "an instruction that this processor does not have",
    "SIGKILL": "killed from outside; is the memory of this machine exhausted?",
}


@dataclass(frozen=True)
class Died:
    """Why a process gave no result. is_timeout: it took longer than the whole was allowed to."""

    reason: str
    is_timeout: bool = False


@dataclass
class _Task:
    """A function that is to run, and how long its present call into an FMU has been seen."""

    future: "ProcessFuture[Any]"
    note: Path
    seen: int = 0
    looks: int = 0
    stuck_s: float = 0.0


def _apart(folder: Path, note: Path, function: Callable[..., T], *arguments: Any) -> T:
    """Run in the child."""
    # How it dies is told from outside, with the name of the FMU; a stack of Python tells nothing
    faulthandler.disable()
    # The command line's handler would wait for a call that never comes back
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    share_session_folder(folder)
    journal.begin(note)
    return function(*arguments)


def run_apart(
    function: Callable[..., T],
    tasks: Sequence[Sequence[Any]],
    *,
    jobs: int = 1,
    is_fresh: bool = True,
    timeout_s: float | None = None,
    call_limit_s: float = CALL_LIMIT_S,
    is_unrelated: bool = False,
) -> Iterator[T | Died]:
    """Yield `function(*task)` of every task, in their order, from processes.

    jobs: processes at a time. is_fresh: a new process for every task; else one may do several.
    is_unrelated: new processes share no memory layout with this one, and start slower.
    timeout_s: wall time of one task, None = no limit. call_limit_s: wall time that one call into
    an FMU may take. Exceptions of the function are raised here.
    """
    if not tasks:
        return
    folder = session_folder()  # made here, so that it outlives the children
    notes = Path(mkdtemp(prefix="notes-", dir=folder))
    pool = ProcessPool(
        max_workers=min(jobs, len(tasks)),
        max_tasks=int(is_fresh),
        context=get_context("spawn" if is_unrelated else None),
    )
    try:
        running: list[_Task] = []
        for number, task in enumerate(tasks):
            note = notes / str(number)
            journal.create(note)
            arguments = [folder, note, function, *task]
            running.append(_Task(pool.schedule(_apart, arguments, timeout=timeout_s), note))
        for number, started in enumerate(running):
            yield _result(started, running[number:], timeout_s, call_limit_s)
        pool.close()  # type: ignore[no-untyped-call]
    except BaseException:
        pool.stop()  # type: ignore[no-untyped-call]  # nobody waits for what is left
        raise
    finally:
        pool.join()


def do_apart(
    function: Callable[..., T], *arguments: Any, file: Path, call_limit_s: float = CALL_LIMIT_S
) -> T:
    """Return `function(*arguments)` from a process of its own.

    Raises what it raises, and UserError with `file` when the process gives no result.
    """
    (result,) = run_apart(function, [arguments], call_limit_s=call_limit_s)
    if isinstance(result, Died):
        raise UserError(result.reason, file=file)
    return result


def _result(
    task: _Task, all_tasks: Sequence[_Task], timeout_s: float | None, call_limit_s: float
) -> Any:
    while True:
        try:
            return task.future.result(timeout=_LOOK_S)
        except PoolTimeout:
            if task.future.done():
                return Died(f"no end within {timeout_s:g} s of wall time{_was_in(task)}", True)
            _end_stuck(all_tasks, call_limit_s)
        except CancelledError:
            return Died(f"a call did not come back within {call_limit_s:g} s{_was_in(task)}")
        except ProcessExpired as error:
            return Died(_death(error.exitcode, task))


def _end_stuck(tasks: Sequence[_Task], call_limit_s: float) -> None:
    """End the processes whose present call into an FMU has lasted too long."""
    for task in tasks:
        if not task.future.running():
            continue
        call = journal.last_call(task.note)
        if call is None or not call.is_inside or call.number != task.seen:
            task.seen, task.stuck_s = (call.number if call else 0), 0.0
            continue
        task.stuck_s += _LOOK_S
        if task.stuck_s >= call_limit_s:
            task.future.cancel()  # type: ignore[no-untyped-call]


def _was_in(task: _Task) -> str:
    call = journal.last_call(task.note)
    return f": it was in {call}" if call is not None and call.is_inside else ""


def _death(exit_code: int, task: _Task) -> str:
    call = journal.last_call(task.note)
    how = _how(exit_code)
    if call is None:
        return f"the process ended before any call into an FMU: {how}"
    if not call.is_inside:
        return f"the process ended: {how}; the last call into an FMU was {call}"
    verb = "ended the process" if exit_code >= 0 else "crashed"
    return f"FMU {call.file} (plant {call.instance}) {verb} in {call.function} at t = " + (
        f"{call.time_ns / 1e6:.6f} ms: {how}"
    )


def _how(exit_code: int) -> str:
    if exit_code >= 0:
        return f"exit code {exit_code}"
    try:
        name = signal.Signals(-exit_code).name
    except ValueError:
        return f"signal {-exit_code}"
    return f"{name}, {_HINTS[name]}" if name in _HINTS else name
