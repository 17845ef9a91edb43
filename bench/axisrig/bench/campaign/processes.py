"""Runs functions that call foreign code in processes of their own, and says how one died.

A crash (or an FMU that ends the process, with whatever code) costs one result, a call that never
comes back is ended. The processes themselves are watched, not what they say: one that is gone
without its answer has died. What it was in the middle of is read from its journal
(kernel/axisrig/kernel/cosim/fmi/journal.py).
"""

import os
import signal
import sys
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from multiprocessing import get_context
from multiprocessing.connection import wait
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, TypeVar

from axisrig.bench.campaign.channel import ChannelError, Inbox
from axisrig.bench.campaign.worker import PARENT_ENDS, Answer, Line, Order, output_of, say, work
from axisrig.bench.rig.fmu_output import cut, lines_in, output_lines
from axisrig.bench.rig.reading.foreign import foreign_rigs
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError

T = TypeVar("T")

CALL_LIMIT_S = 60.0
TASKS_MAX = 250
"""So many tasks a process does; then a new one takes its place, with the memory that it needs."""
_LOOK_S = 0.25  # how often the parent looks at processes and journals when nothing is heard
_REST_S = 0.01  # between looks when what there is to hear is nothing
_GRACE_S = 2.0  # so long a process may take to end after its connection has broken off
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
    """Why a process gave no result.

    is_timeout: it took longer than the whole was allowed to. log: what it had written to standard
    output.
    """

    reason: str
    is_timeout: bool = False
    log: Sequence[str] = ()


class _Worker:
    """A process and what it is doing. number: of its task, None when it waits for one."""

    def __init__(self, context: Any, folder: Path) -> None:
        self.pipe, theirs = context.Pipe()
        PARENT_ENDS.add(self.pipe)
        self.inbox = Inbox(self.pipe, time.monotonic)
        # Daemons end with this process, whatever it ends by in Python
        arguments = (theirs, folder, os.getpid())
        self.process = context.Process(target=work, args=arguments, daemon=True)
        self.process.start()
        theirs.close()  # so that its end is heard here
        self.number: int | None = None
        self.done = 0
        self.note = Path()
        self.began_s = self.call_s = 0.0
        self.call = 0

    def order(self, number: int, order: Order) -> bool:
        """Hand out a task; False when the process is there no more."""
        try:
            self.inbox.order(order)
        except OSError:
            return False
        self.number, self.note, self.call = number, order.note, 0
        self.began_s = self.call_s = time.monotonic()
        return True

    def end(self) -> None:
        """End the process if it has not ended: an endless thread of an FMU would keep it.

        It takes a while to give its memory back; see `wait`.
        """
        self.process.kill()
        PARENT_ENDS.discard(self.pipe)
        self.pipe.close()

    def wait(self) -> None:
        """Wait until the process is gone."""
        self.process.join()
        self.process.close()


@dataclass
class _Crew:
    """Processes at work on tasks; `answers` has those that came and were not taken, by number.

    is_fresh: for each task, whether it gets a new process that does nothing else. news: called with
    the number of a task when it begins (True) and when it has ended (False).
    """

    function: Callable[..., Any]
    tasks: Sequence[Sequence[Any]]
    is_fresh: Sequence[bool]
    jobs: int
    context: Any
    timeout_s: float | None
    call_limit_s: float
    tasks_max: int
    news: Callable[[int, bool], None]

    def __post_init__(self) -> None:
        self.answers: dict[int, Answer] = {}
        self._workers: list[_Worker] = []
        self._ending: list[_Worker] = []  # nobody waits for them while there is work
        self._next = 0
        self._folder = session_folder()  # made here, so that it outlives the children

    @cached_property
    def _notes(self) -> Path:
        return Path(mkdtemp(prefix="notes-", dir=self._folder))

    def look(self) -> None:
        """Hand out what is to be done, wait for news, take what has ended; hand out more.

        Who asked for the answers has work with them: nobody waits for that.
        """
        self._hand_out()
        news = [item for w in self._workers for item in (w.pipe, w.process.sentinel)]
        heard = wait(news, _LOOK_S)
        pipes = [worker.pipe for worker in self._workers]
        if heard and all(w.process.exitcode is None and w.pipe not in heard for w in self._workers):
            wait(pipes, _REST_S)  # foreign code wrote where only the end of its process belongs
        for worker in list(self._workers):
            if worker.number is not None:
                self._hear(worker)
        self._hand_out()
        for worker in [w for w in self._workers if w.number is None]:
            if self._next == len(self.tasks) or worker.process.exitcode is not None:
                self._dismiss(worker)

    def _hand_out(self) -> None:
        """Give every free process a task."""
        while self._next < len(self.tasks) and (worker := self._free(self._next)) is not None:
            note = self._notes / str(self._next)
            journal.create(note)
            order = Order(note, self.function, self.tasks[self._next])
            if worker.order(self._next, order):
                self.news(self._next, True)
                self._next += 1
            else:
                self._dismiss(worker)

    def _free(self, number: int) -> _Worker | None:
        """Return a process for a task, None when all are busy."""
        idle = [worker for worker in self._workers if worker.number is None]
        if idle and not self.is_fresh[number] and idle[0].process.exitcode is None:
            return idle[0]
        for worker in idle[:1]:
            self._dismiss(worker)
        if len(self._workers) >= self.jobs:
            return None
        self._workers.append(_Worker(self.context, self._folder))
        return self._workers[-1]

    def _hear(self, worker: _Worker) -> None:
        """Take what a process says; see whether it is there still and within its limits."""
        is_gone = worker.process.exitcode is not None  # asked first: it may answer and end then
        while True:
            try:
                said = worker.inbox.take()
            except (EOFError, OSError):
                said, is_gone = None, True
            except Exception as error:  # what is no answer may be anything
                return self._take(worker, Answer(_no_answer(worker, error)), is_last=True)
            if isinstance(said, Line):
                say(said.text)
            elif isinstance(said, Answer):
                if said.lowered:
                    reason = f"{said.error}; it had lowered limits of its process: {said.lowered}"
                    answer = Answer(Died(reason, log=_printed(worker)))
                    return self._take(worker, answer, is_last=True)  # its limits stay lowered
                return self._take(worker, said, is_last=False)
            else:
                break
        died = self._death(worker) if is_gone else self._excess(worker)
        if died is not None:
            self._take(worker, Answer(died), is_last=True)

    def _take(self, worker: _Worker, answer: Answer, *, is_last: bool) -> None:
        assert worker.number is not None
        self.answers[worker.number] = answer
        self.news(worker.number, False)
        worker.done += 1
        if is_last or self.is_fresh[worker.number] or worker.done >= self.tasks_max:
            self._dismiss(worker)
        worker.number = None

    def _dismiss(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.end()
        gone = [other for other in self._ending if other.process.exitcode is not None]
        self._ending = [*(other for other in self._ending if other not in gone), worker]
        for other in gone:
            other.wait()

    def _excess(self, worker: _Worker) -> Died | None:
        """Say which limit a process has passed."""
        cut(output_of(worker.note))
        now_s, call = time.monotonic(), journal.last_call(worker.note)
        if self.timeout_s is not None and now_s - worker.began_s >= self.timeout_s:
            reason = f"no end within {self.timeout_s:g} s of wall time{_was_in(call)}"
            return Died(reason, True, _printed(worker))
        if call is None or not call.is_inside or call.number != worker.call:
            worker.call, worker.call_s = (call.number if call else 0), now_s
        elif now_s - worker.call_s >= self.call_limit_s:
            reason = f"a call did not come back within {self.call_limit_s:g} s{_was_in(call)}"
            return Died(reason, log=_printed(worker))
        return None

    def _death(self, worker: _Worker) -> Died:
        worker.process.join(_GRACE_S)
        reason = _in_words(worker.process.exitcode, journal.last_call(worker.note))
        return Died(reason, log=_printed(worker))

    def answer(self, number: int) -> Any:
        """Wait for the answer to a task and return it; an exception is raised here."""
        while number not in self.answers:
            self.look()
        answer = self.answers.pop(number)
        if answer.error is not None:
            raise answer.error
        return answer.value

    def dismiss(self) -> None:
        """End every process."""
        for worker in list(self._workers):
            self._dismiss(worker)
        for worker in self._ending:
            worker.wait()


def _no_news(_number: int, _begins: bool) -> None:
    """Follow no task."""


def usable_cores(cpu_max: Path = Path("/sys/fs/cgroup/cpu.max")) -> int:
    """Return how many cores this process may use: its affinity, and the quota of its cgroup.

    cpu_max: file of cgroup v2 with quota and period in us, or `max` (kernel documentation,
    "Control Group v2", CPU interface files); where it is missing, there is no quota.
    """
    if sys.platform == "linux":
        cores = len(os.sched_getaffinity(0))
    else:
        cores = os.cpu_count() or 1
    try:
        quota, period = cpu_max.read_text(encoding="ascii").split()
        limit = cores if quota == "max" else max(1, int(quota) // int(period))
    except (OSError, ValueError, ZeroDivisionError):
        limit = cores
    return min(cores, limit)


def run_apart(  # noqa: PLR0913
    function: Callable[..., T],
    tasks: Sequence[Sequence[Any]],
    *,
    jobs: int = 1,
    is_fresh: bool | Sequence[bool] = True,
    timeout_s: float | None = None,
    call_limit_s: float = CALL_LIMIT_S,
    is_unrelated: bool = False,
    tasks_max: int = TASKS_MAX,
    news: Callable[[int, bool], None] = _no_news,
) -> Generator[T | Died, None, None]:
    """Yield `function(*task)` of every task, in their order, from processes.

    jobs: processes at a time. is_fresh: a new process for every task, or for which; another may do
    several. is_unrelated: new processes share no memory layout with this one, and start slower.
    tasks_max: after so many tasks a process ends and a new one takes its place.
    timeout_s: wall time of one task, None = no limit. call_limit_s: wall time that one call into
    an FMU may take. news: called with the number of a task when it begins (True) and when it has
    ended (False). Exceptions of the function are raised here.
    """
    fresh = [is_fresh] * len(tasks) if isinstance(is_fresh, bool) else is_fresh
    context = get_context("spawn" if is_unrelated else None)
    crew = _Crew(function, tasks, fresh, jobs, context, timeout_s, call_limit_s, tasks_max, news)
    try:
        for number in range(len(tasks)):
            yield crew.answer(number)
    finally:
        crew.dismiss()


def run_as_they_end(
    function: Callable[..., T],
    tasks: Sequence[Sequence[Any]],
    *,
    jobs: int,
    is_fresh: Sequence[bool],
    timeout_s: float | None,
    call_limit_s: float,
    news: Callable[[int, bool], None] = _no_news,
) -> Generator[tuple[int, T | Died], None, None]:
    """Yield the number of a task, from 0, and `function(*task)`, in the order in which they end.

    Arguments as of `run_apart`.
    """
    context = get_context()
    crew = _Crew(function, tasks, is_fresh, jobs, context, timeout_s, call_limit_s, TASKS_MAX, news)
    try:
        for _ in tasks:
            while not crew.answers:
                crew.look()
            number = next(iter(crew.answers))
            yield number, crew.answer(number)
    finally:
        crew.dismiss()


def do_apart(
    function: Callable[..., T],
    *arguments: Any,
    rigs: Iterable[Path],
    file: Path,
    limits: tuple[bool, float | None] = (False, None),
) -> T:
    """Return `function(*arguments)`, which loads the plants of `rigs`.

    From a process of its own where a rig names a foreign FMU, or `limits` (--isolate,
    --call-timeout in s) ask for one. Raises what it raises, and UserError with `file` when a
    process gives no result.
    """
    is_isolated, call_limit_s = limits
    if not (is_isolated or call_limit_s is not None or foreign_rigs(rigs)):
        return function(*arguments)
    (result,) = run_apart(function, [arguments], call_limit_s=call_limit_s or CALL_LIMIT_S)
    if isinstance(result, Died):
        raise UserError(result.reason, file=file)
    return result


def _no_answer(worker: _Worker, error: Exception) -> Died:
    """Say that a process wrote something else than its answer where that belongs."""
    call = journal.last_call(worker.note)
    last = "" if call is None else f"; its last call was {call}"
    what = str(error) if isinstance(error, ChannelError) else f"{type(error).__name__}: {error}"
    reason = f"something in the process wrote into the channel of its answer: {what}{last}"
    return Died(reason, log=_printed(worker))


def _printed(worker: _Worker) -> list[str]:
    return output_lines("the process", lines_in(output_of(worker.note)))


def _was_in(call: journal.LastCall | None) -> str:
    return f": it was in {call}" if call is not None and call.is_inside else ""


def _in_words(exit_code: int | None, call: journal.LastCall | None) -> str:
    """Say how a process ended; exit_code: None when it only broke off its connection."""
    how = "it broke off its connection" if exit_code is None else _how(exit_code)
    if call is None:
        return f"the process ended before any call into an FMU: {how}"
    if not call.is_inside:
        return f"the process ended: {how}; the last call was {call}"
    verb = "crashed" if exit_code is not None and exit_code < 0 else "ended the process"
    return f"{call.what} {verb} in {call.function} at t = {call.time_ns / 1e6:.6f} ms: {how}"


def _how(exit_code: int) -> str:
    if exit_code >= 0:
        return f"exit code {exit_code}"
    try:
        name = signal.Signals(-exit_code).name
    except ValueError:
        return f"signal {-exit_code}"
    return f"{name}, {_HINTS[name]}" if name in _HINTS else name
