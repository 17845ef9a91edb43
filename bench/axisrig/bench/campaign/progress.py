"""What a campaign shows while it lasts: its progress, and what goes on beside it."""

from collections import Counter, deque
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

from rich.console import Console, RenderableType
from rich.progress import Progress, SpinnerColumn, TextColumn

from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import Stopwatch
from axisrig.bench.campaign.talk import Talk
from axisrig.bench.plan.verdict import Verdict

LINE_EVERY_S = 30.0
"""Without a terminal, the state of the campaign is written as often as this."""
ENDED_MAX = 8
"""So many runs that have ended a page shows, the last ones."""
_NAMED = 3
"""So many of the runs that are under way are named."""


class CampaignProgress:
    """Writes lines of runs to standard error, and how far the campaign is.

    On a terminal that is a line at the bottom; else one of its own every 30 s. The runs themselves
    may take longer than that: `tick` has to be called by somebody who does not wait for them, often
    enough for a line that moves.
    """

    def __init__(
        self,
        count: int,
        stopwatch: Stopwatch,
        console: Console | None = None,
        *,
        statistics: int = 0,
        talk: Talk = Talk.ALL,
    ) -> None:
        """Take the number of runs, of rows of statistics, and what gives seconds of wall time.

        talk: which runs have a line; in short: the first run of a case that did not pass.
        """
        self._talk, self._failing = talk.of(count + statistics), set[tuple[str, str, Verdict]]()
        self._count, self._stopwatch = count + statistics, stopwatch
        self._of = "rows" if statistics else "runs"
        self._began_s = self._said_s = stopwatch()
        self._counts: Counter[Verdict] = Counter()
        self._running: dict[str, float] = {}
        self._ended: deque[tuple[str, Verdict]] = deque(maxlen=ENDED_MAX)
        self._console = console or Console(stderr=True, highlight=False, markup=False, emoji=False)
        # A thread of rich would print while processes are forked
        columns = (SpinnerColumn(), TextColumn("{task.description}"))
        self._bar = _Bar(*columns, console=self._console, transient=True, auto_refresh=False)
        self._task = self._bar.add_task(self.state)

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._console.is_terminal:
            self._bar.stop()

    def show_beneath(self, draw: Callable[[], RenderableType] | None) -> None:
        """Draw something beneath the line at the bottom of a terminal, with each tick."""
        self._bar.draw = draw

    def began(self, run: str) -> None:
        """Note a run that begins."""
        self._running[run] = self._stopwatch()

    def ended(self, run: str) -> None:
        """Note a run that has ended."""
        self._running.pop(run, None)

    def show(self, result: CaseResult) -> None:
        """Show a run that has ended."""
        run, verdict = result.case.run, result.verdict
        self._running.pop(run, None)
        self._counts[verdict] += 1
        self._ended.append((run, verdict))
        if self._talk is Talk.ALL or (self._talk is Talk.SHORT and self._is_first(result)):
            self._console.print(f"{verdict.glyph} {verdict.word:<12} {run}", soft_wrap=True)
        self._bar.update(self._task, description=self.state)

    def _is_first(self, result: CaseResult) -> bool:
        """Whether it is the first run of its case that did not pass in this way."""
        key = (result.case.plan, result.case.case, result.verdict)
        is_first = result.verdict > Verdict.MARGINAL and key not in self._failing
        self._failing.add(key)
        return is_first

    def tick(self) -> None:
        """Say how far it is, where that is due."""
        if self._console.is_terminal:
            self._bar.update(self._task, description=self.state, refresh=True)
        elif (now_s := self._stopwatch()) - self._said_s >= LINE_EVERY_S:
            self._said_s = now_s
            self._console.print(self.state, soft_wrap=True)

    @property
    def state(self) -> str:
        """How far it is: runs, verdicts, runs per second, time that is left, what is running."""
        now_s = self._stopwatch()
        done, spent_s = self._counts.total(), now_s - self._began_s
        words = [f"{done}/{self._count} {self._of}"]
        words += [f"{self._counts[one]} {one.word}" for one in Verdict if self._counts[one]]
        if done and spent_s > 0.0:
            rate_hz = done / spent_s
            words += [
                f"{rate_hz:.3g} {self._of}/s",
                f"{duration((self._count - done) / rate_hz)} left",
            ]
        running = sorted(self._running.items(), key=lambda item: item[1])
        named = [f"{run} for {duration(now_s - began)}" for run, began in running[:_NAMED]]
        more = [f"{len(running) - _NAMED} more"] if len(running) > _NAMED else []
        return ", ".join(words) + (f"; running: {', '.join([*named, *more])}" if running else "")

    def as_data(self) -> dict[str, object]:
        """Return the same for a page: runs, verdicts, and the last runs that ended."""
        counts, now_s = dict(self._counts), self._stopwatch()
        return {
            "count": self._count,
            "done": sum(counts.values()),
            "spent_s": now_s - self._began_s,
            "state": self.state,
            "verdicts": [_verdict(one) | {"runs": counts[one]} for one in Verdict if one in counts],
            "ended": [_verdict(verdict) | {"run": run} for run, verdict in list(self._ended)],
        }


class _Bar(Progress):
    """The line at the bottom of a terminal, and what is drawn beneath it."""

    draw: Callable[[], RenderableType] | None = None

    def get_renderables(self) -> Iterable[RenderableType]:
        """Return what is drawn."""
        yield from super().get_renderables()
        if self.draw is not None:
            yield self.draw()


def _verdict(verdict: Verdict) -> dict[str, object]:
    return {"verdict": verdict.word, "glyph": verdict.glyph}


@dataclass(frozen=True)
class Watch:
    """What the command line does beside the runs of a campaign.

    beside: gets the progress, and is open while the runs last. live: the pipe that takes the states
    of the runs, one run at a time; None where nobody looks on.
    """

    beside: Callable[[CampaignProgress], AbstractContextManager[object]] = nullcontext
    live: Path | None = None

    def files_of(self, files_of: Callable[[str], RunFiles]) -> Callable[[str], RunFiles]:
        """Return what gives the files of a run, its pipe for states among them."""
        return lambda run: files_of(run).with_live(self.live)


def duration(seconds: float) -> str:
    """Write a time as hours and minutes, minutes and seconds, or seconds."""
    whole = round(seconds)
    hours, minutes = divmod(whole // 60, 60)
    if hours:
        return f"{hours} h {minutes:02} min"
    return f"{minutes} min {whole % 60:02} s" if minutes else f"{whole} s"
