"""Progress of a campaign by a clock that the test sets: a line every 30 s, or on a terminal."""

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rich.console import Console
from rich.text import Text

from axisrig.bench.campaign.progress import CampaignProgress, Watch, duration
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.talk import Talk
from axisrig.bench.plan.plan import counted
from axisrig.bench.plan.verdict import Verdict


class Shown:
    """A progress whose clock the test sets, without a terminal."""

    def __init__(self, count: int) -> None:
        self.now_s, self._text = 0.0, io.StringIO()
        console = Console(
            file=self._text, force_terminal=False, width=200, highlight=False, markup=False
        )
        self.progress = CampaignProgress(count, lambda: self.now_s, console)

    def wait(self, seconds: int) -> None:
        """Let time pass, with the tick of every second."""
        for _ in range(seconds):
            self.now_s += 1.0
            self.progress.tick()

    def show(self, run: str, verdict: Verdict = Verdict.PASS) -> None:
        result = SimpleNamespace(verdict=verdict, case=SimpleNamespace(run=run))
        self.progress.show(cast(CaseResult, result))

    @property
    def lines(self) -> list[str]:
        return self._text.getvalue().splitlines()


def test_rows_of_statistics_are_counted_as_such() -> None:
    progress = CampaignProgress(16, lambda: 1.0, Console(file=io.StringIO()), statistics=1)
    assert progress.state == "0/17 rows"
    assert (counted(16, 1), counted(1, 0)) == ("16 runs and 1 row of statistics", "1 run")


def test_a_line_every_thirty_seconds_says_how_far_it_is() -> None:
    shown = Shown(300)  # lines are due at 31 s and 61 s: nothing ticks at 30 s and 60 s
    with shown.progress:
        for number in range(7):
            shown.wait(9)
            shown.now_s += 1.0
            shown.show(f"r{number}", Verdict.FAIL if number == 2 else Verdict.PASS)
    assert [line for line in shown.lines if "runs/s" in line] == [
        "3/300 runs, 2 pass, 1 fail, 0.0968 runs/s, 51 min 09 s left",
        "6/300 runs, 5 pass, 1 fail, 0.0984 runs/s, 49 min 49 s left",
    ]
    assert sum(line.split()[-1].startswith("r") for line in shown.lines) == 7


def test_a_long_run_has_its_lines_while_it_lasts() -> None:
    """600 s of one run: 20 lines, at 30, 60, ... s, that name it with its time."""
    shown = Shown(2)
    with shown.progress:
        shown.wait(5)
        shown.show("first")
        shown.progress.began("slow-1")
        shown.wait(600)
    lines = [line for line in shown.lines if "runs/s" in line]
    assert len(lines) == 20
    assert lines[0] == "1/2 runs, 1 pass, 0.0333 runs/s, 30 s left; running: slow-1 for 25 s"
    assert lines[19].endswith("; running: slow-1 for 9 min 55 s")


def test_those_that_run_longest_are_named() -> None:
    shown = Shown(9)
    for number in range(6):
        shown.progress.began(f"r{number}")
        shown.now_s += 10.0
    shown.progress.ended("r1")
    shown.show("r1", Verdict.FAIL)
    assert shown.progress.state == (
        "1/9 runs, 1 fail, 0.0167 runs/s, 8 min 00 s left;"
        " running: r0 for 1 min 00 s, r2 for 40 s, r3 for 30 s, 2 more"
    )
    shown.progress.ended("r0")
    shown.show("r0")
    assert shown.progress.state.startswith("2/9 runs, 1 pass, 1 fail, 0.0333 runs/s")


def test_a_page_gets_counts_and_the_runs_that_ended_last() -> None:
    shown = Shown(20)
    for number in range(10):
        shown.show(f"r{number}", Verdict.FAIL if number == 9 else Verdict.PASS)
    data = shown.progress.as_data()
    assert (data["count"], data["done"]) == (20, 10)
    assert [(row["verdict"], row["runs"]) for row in cast(list[Any], data["verdicts"])] == [
        ("pass", 9),
        ("fail", 1),
    ]
    ended = cast(list[Any], data["ended"])
    assert [row["run"] for row in ended] == [f"r{number}" for number in range(2, 10)]
    assert ended[-1]["glyph"] == Verdict.FAIL.glyph


def test_in_short_only_the_first_run_of_a_case_that_failed_in_a_way_has_a_line() -> None:
    """By plan, case and verdict; what passed, or passed with little room, has none."""
    text = io.StringIO()
    console = Console(file=text, force_terminal=False, width=200, highlight=False, markup=False)
    progress = CampaignProgress(99, lambda: 1.0, console, talk=Talk.SHORT)
    runs = [
        ("a", "x", Verdict.PASS), ("a", "x", Verdict.MARGINAL), ("a", "x", Verdict.FAIL),
        ("a", "x", Verdict.FAIL), ("a", "x", Verdict.ABORTED), ("a", "y", Verdict.FAIL),
        ("b", "x", Verdict.FAIL), ("a", "x", Verdict.ABORTED), ("b", "x", Verdict.FAIL),
    ]  # fmt: skip
    for number, (plan, name, verdict) in enumerate(runs):
        case = SimpleNamespace(run=f"r{number}", plan=plan, case=name)
        progress.show(cast(CaseResult, SimpleNamespace(verdict=verdict, case=case)))
    assert [line.split()[-1] for line in text.getvalue().splitlines()] == ["r2", "r4", "r5", "r6"]


class OnTerminal(Shown):
    """The same on a terminal, whose lines are drawn over each other."""

    def __init__(self, count: int) -> None:
        self.now_s, self._text = 0.0, io.StringIO()
        console = Console(file=self._text, force_terminal=True, width=200)
        self.progress = CampaignProgress(count, lambda: self.now_s, console)

    def drawn(self, seconds: int = 1) -> str:
        """What has been drawn in so many more seconds."""
        self._text.seek(0)
        self._text.truncate()
        self.wait(seconds)
        return self._text.getvalue()


def test_on_a_terminal_each_tick_draws_the_line_until_the_end() -> None:
    shown = OnTerminal(4)
    assert shown.drawn() == ""  # nothing before its begin
    with shown.progress:
        shown.progress.began("a")
        assert "0/4 runs; running: a for 1 s" in shown.drawn()
        shown.show("a", Verdict.FAIL)
        # 3 s for 1 of 4 runs: 9 s for the other three
        assert "1/4 runs, 1 fail, 0.333 runs/s, 9 s left" in shown.drawn()
        assert "\n" not in shown.drawn(60)  # it is drawn over itself: no line every 30 s
    assert shown.drawn(60) == ""


def test_something_is_drawn_beneath_the_line_as_long_as_it_is_wanted() -> None:
    """Anew with each tick; then another one, and none."""
    shown = OnTerminal(1)

    def draw() -> Text:
        return Text(f"picture of {shown.now_s:g} s")

    with shown.progress:
        assert "picture" not in shown.drawn()
        shown.progress.show_beneath(draw)
        text = shown.drawn()
        assert 0 <= text.find("0/1 runs") < text.find("picture of 2 s")
        assert "picture of 3 s" in shown.drawn()
        shown.progress.show_beneath(lambda: "another one")
        assert "another one" in (text := shown.drawn())
        assert "picture" not in text
        shown.progress.show_beneath(None)
        assert "0/1 runs" in (text := shown.drawn())
        assert "another one" not in text


def test_a_time_is_written_in_its_largest_units() -> None:
    """Seconds are rounded first: 59.6 s are a minute."""
    times_s = (0.4, 59.4, 59.6, 60.0, 61.0, 3599.4, 3599.6, 3660.0, 36_059.0)
    assert [duration(one) for one in times_s] == [
        *("0 s", "59 s", "1 min 00 s", "1 min 00 s", "1 min 01 s", "59 min 59 s"),
        *("1 h 00 min", "1 h 01 min", "10 h 00 min"),
    ]


@pytest.mark.parametrize(
    ("talk", "lines"), [(Talk.ALL, ["r0", "r1"]), (Talk.NONE, []), (Talk.SHORT, ["r1"])]
)
def test_runs_have_their_lines_as_far_as_asked_for(talk: Talk, lines: list[str]) -> None:
    text = io.StringIO()
    console = Console(file=text, force_terminal=False, width=200, highlight=False, markup=False)
    progress = CampaignProgress(99, lambda: 1.0, console, talk=talk)
    for run, verdict in (("r0", Verdict.PASS), ("r1", Verdict.FAIL)):
        case = SimpleNamespace(run=run, plan="p", case=run)
        progress.show(cast(CaseResult, SimpleNamespace(verdict=verdict, case=case)))
    assert [line.split()[-1] for line in text.getvalue().splitlines()] == lines


def test_a_live_view_has_its_pipe_in_the_files_of_each_run_and_probe() -> None:
    files = RunFiles([Path("a.blf")], Path("a.parquet"), [RunFiles([], Path("s.parquet"), [])])
    assert Watch().files_of(lambda _: files)("a") == files
    watched = Watch(live=Path("live")).files_of(lambda run: files)("a")
    assert (watched.live, [probe.live for probe in watched.probes]) == (
        Path("live"),
        [Path("live")],
    )
    assert (watched.bus_logs, watched.trace) == (files.bus_logs, files.trace)


def test_runs_are_named_by_when_they_began_and_not_after_they_were_shown() -> None:
    """Whatever their names are; a run that is shown runs no more, though nobody has ended it."""
    shown = Shown(5)
    for run in ("z", "m", "a"):
        shown.progress.began(run)
        shown.now_s += 10.0
    assert shown.progress.state == "0/5 runs; running: z for 30 s, m for 20 s, a for 10 s"
    shown.show("m")
    assert shown.progress.state.endswith("; running: z for 30 s, a for 10 s")
    shown.show("other")
    assert shown.progress.state.endswith("; running: z for 30 s, a for 10 s")
    shown.show("z")
    shown.show("a")
    assert "running" not in shown.progress.state


def test_a_state_is_one_line_however_narrow_the_console_is() -> None:
    """Of a pipe the width is not known: a log is read line by line."""
    text = io.StringIO()
    now_s = 0.0
    console = Console(file=text, force_terminal=False, width=20, highlight=False, markup=False)
    progress = CampaignProgress(300, lambda: now_s, console)
    progress.began("a-run-with-a-long-name-of-many-words-1")
    now_s = 30.0
    progress.tick()
    assert text.getvalue() == (
        "0/300 runs; running: a-run-with-a-long-name-of-many-words-1 for 30 s\n"
    )


def test_a_page_gets_the_time_since_the_begin_whatever_was_shown_since() -> None:
    shown = Shown(3)
    shown.wait(40)  # a line at 30 s
    shown.show("a")
    assert shown.progress.as_data()["spent_s"] == 40.0
    shown.wait(35)
    assert shown.progress.as_data()["spent_s"] == 75.0
