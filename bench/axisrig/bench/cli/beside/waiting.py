"""The line of a command that takes longer than a second: what it does, and for how long.

It goes to standard error: on a terminal at the bottom, else once at the begin and then every 30 s.
Only the process of the command line shows it; who calls its commands from Python hears nothing.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import TYPE_CHECKING, Protocol, TypeVar

from axisrig.bench.cli.beside.ticking import ticking

if TYPE_CHECKING:
    from rich.progress import Progress

T = TypeVar("T")
LINE_EVERY_S = 30.0


class Waiting:
    """Says what is being done; `tick` has to be called often enough for a line that moves."""

    def __init__(self, text: str, clock: Callable[[], float], *, is_terminal: bool) -> None:
        """Begin with a text. clock: gives seconds of wall time."""
        self._text, self._inside, self._clock = text, "", clock
        self._began_s = self._said_s = clock()
        self._is_terminal, self._has_ended = is_terminal, False
        self._bar: Progress | None = None
        if not is_terminal:
            print(text, file=sys.stderr, flush=True)

    def say(self, text: str) -> None:
        """Do something else from now on."""
        self._text = text

    def inside(self, text: str) -> None:
        """Do something within it, such as the build of an FMU; empty: no more."""
        self._inside = text

    def tick(self) -> None:
        """Show the line, where that is due."""
        now_s = self._clock()
        spent_s = now_s - self._began_s
        words = f"{self._inside or self._text}, {spent_s:.0f} s"
        if self._is_terminal:
            if not self._has_ended:
                self._draw(words)
        elif not self._has_ended and now_s - self._said_s >= LINE_EVERY_S:
            self._said_s = now_s
            print(words, file=sys.stderr, flush=True)

    @contextmanager
    def beside(
        self, others: Callable[[T], AbstractContextManager[object]], progress: T
    ) -> Iterator[None]:
        """Give way to other lines while the block lasts."""
        self.end()
        with others(progress):
            yield
        self._has_ended = False
        self._began_s = self._said_s = self._clock()

    def end(self) -> None:
        """Take the line away."""
        self._has_ended = True
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _draw(self, words: str) -> None:
        from rich.console import Console  # noqa: PLC0415 - takes long to load
        from rich.progress import Progress, SpinnerColumn, TextColumn  # noqa: PLC0415

        if self._bar is None:
            console = Console(stderr=True, highlight=False, markup=False, emoji=False)
            columns = (SpinnerColumn(), TextColumn("{task.description}"))
            self._bar = Progress(
                *columns,
                console=console,
                transient=True,
                auto_refresh=False,  # its thread would print while processes are forked
                redirect_stdout=sys.stdout.isatty(),  # into a file it is none of its business
            )
            self._bar.add_task(words)
            self._bar.start()
        self._bar.update(self._bar.task_ids[0], description=words, refresh=True)


class Line(Protocol):
    """What a command says it is doing, to whoever looks on."""

    def say(self, text: str) -> None: ...  # noqa: D102
    def beside(  # noqa: D102
        self, others: Callable[[T], AbstractContextManager[object]], progress: T
    ) -> AbstractContextManager[None]: ...


class _Nobody:
    """Takes what is being done where nobody looks on."""

    def say(self, text: str) -> None:
        pass

    @contextmanager
    def beside(
        self, others: Callable[[T], AbstractContextManager[object]], progress: T
    ) -> Iterator[None]:
        with others(progress):
            yield


_clocks: list[Callable[[], float]] = []
"""Of the process of the command line, which shows its lines; else nothing."""


def show_waiting(clock: Callable[[], float]) -> None:
    """Let the commands of this process show their lines. clock: gives seconds of wall time."""
    _clocks.append(clock)


@contextmanager
def waiting(text: str, *, has_lines: bool = False) -> Iterator[Line]:
    """Show what is being done while the block lasts; gives what changes the text.

    has_lines: other processes write lines to the terminal meanwhile, so nothing moves at its
    bottom: there are lines as in a pipe.
    """
    if not _clocks:
        yield _Nobody()
        return
    line = Waiting(text, _clocks[-1], is_terminal=sys.stderr.isatty() and not has_lines)
    from axisrig.fmus.watching import heard  # noqa: PLC0415 - takes long to load

    with ExitStack() as open_:
        open_.callback(line.end)
        open_.enter_context(heard(line.inside))
        open_.enter_context(ticking(line))
        yield line


@contextmanager
def waiting_for_line(text: str) -> Iterator[Callable[[str], None]]:
    """Show what is being done until the first line is put out; gives what puts lines out."""
    with ExitStack() as stack:
        stack.enter_context(waiting(text))

        def put_out(line: str) -> None:
            stack.close()
            print(line, flush=True)

        yield put_out
