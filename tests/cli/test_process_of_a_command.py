"""The process of a command: its help, its signs, its watch over a reader, what it hands on."""

import io
import signal
import sys
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.campaign.progress import Watch
from axisrig.bench.cli import main as command_line
from axisrig.bench.cli.guard import needs_progress
from axisrig.bench.cli.options import rejecting
from axisrig.bench.cli.start import plain_signs
from axisrig.kernel.errors import UserError

CAMPAIGN = "axisrig.bench.campaign"


@cache
def commands() -> Any:
    """All commands; they take long to make."""
    return typer.main.get_command(command_line.app)


def call(*words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        commands().main([*words])
    return int(ended.value.code or 0)


# Help


@pytest.mark.parametrize(
    ("command", "option", "word"),
    [
        ("run", "--out", "PATH"), ("run", "--timeout", "NUMBER"), ("run", "--bitrate", "N"),
        ("run", "--channel", "TEXT"), ("run", "--jobs", "N|auto"), ("run", "--shard", "I/N"),
        ("run", "--set", "COLUMN=VALUE"), ("run", "--engine", "dask"),
        ("budget", "--out", "PATH"), ("budget", "--combinations", "N"),
        ("bus", "--only", "TEXT"), ("bus", "--from", "NUMBER"), ("bus", "--rig", "PATH"),
        ("probe-feed", "--stroke", "NUMBER"), ("errors", "--class", "N"),
        ("errors", "--format", "text|markdown"), ("scenarios", "--for", "TIME"),
    ],
)  # fmt: skip
def test_what_follows_an_option_is_a_plain_word(
    command: str, option: str, word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(command, "--help") == 0
    lines = capsys.readouterr().out.splitlines()
    (found,) = [line for line in lines if f"{option} " in line and line.lstrip().startswith("-")]
    assert found.partition(f"{option} ")[2].split()[0] == word


@pytest.mark.parametrize("words", [[], ["--help"]])
def test_a_call_of_others_without_words_shows_the_commands(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not the words of the process that calls."""
    monkeypatch.setattr(sys, "argv", ["other", "metrics"])
    with pytest.raises(SystemExit):
        command_line.main(words)
    out, err = capsys.readouterr()
    assert "Commands:" in out + err
    assert "Usage: " in out + err


# Signs


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("5 µ°", "5 udeg"), ("±µ", "+-u"), ("≤≥≠", "<=>=!="), ("✔✖■", "+x#"), ("…–→", "...-->"),
        ("aΩ±b", "a_+-b"), ("±Ω", "+-_"),
    ],
)  # fmt: skip
def test_each_of_several_signs_beside_each_other_has_another(text: str, shown: str) -> None:
    assert text.encode("ascii", errors=plain_signs()).decode("ascii") == shown


def test_both_streams_write_signs_that_a_console_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    streams = [io.TextIOWrapper(io.BytesIO(), encoding="ascii", newline="\n") for _ in range(2)]
    monkeypatch.setattr(sys, "stdout", streams[0])
    monkeypatch.setattr(sys, "stderr", streams[1])
    monkeypatch.setattr(command_line, "end_on_signals", lambda: None)
    monkeypatch.setattr(command_line, "app", lambda _: [print("±", file=one) for one in streams])
    command_line.main(["metrics"])
    for stream in streams:
        stream.flush()
        assert stream.buffer.getvalue() == b"+-\n"  # type: ignore[attr-defined]


# The watch over a reader


needs_timers = pytest.mark.skipif(not hasattr(signal, "SIGVTALRM"), reason="timers of Unix")
LONG_S = 1000.0


def look() -> None:
    """Do what the timer does."""
    signal.raise_signal(signal.SIGVTALRM)


@needs_timers
@pytest.mark.parametrize("places", [[(1, 0), (2, 0), (2, 1), (2, 2)], [(0, 1), (1, 1), (0, 1)]])
def test_a_reader_goes_on_while_frames_or_bytes_do(places: list[tuple[int, int]]) -> None:
    reader = SimpleNamespace(place=(0, 0))
    with needs_progress(reader, Path("a.blf"), LONG_S):
        for reader.place in places:
            look()


@needs_timers
def test_a_reader_that_went_on_stands_still_later() -> None:
    reader = SimpleNamespace(place=(0, 0))
    with needs_progress(reader, Path("own/a.blf"), LONG_S):
        reader.place = (7, 512)
        look()
        message = r"stands still, 7 frames and 512 bytes .* for 1000 s"
        with pytest.raises(UserError, match=message) as caught:
            look()
    assert caught.value.file == str(Path("own/a.blf"))


@needs_timers
def test_a_reader_that_never_begins_stands_still() -> None:
    with (
        pytest.raises(UserError, match=r"0 frames and 0 bytes"),
        needs_progress(SimpleNamespace(place=(0, 0)), Path("a.blf"), LONG_S),
    ):
        look()


# Errors


def test_each_error_of_a_file_has_the_line_that_it_is_about(
    capsys: pytest.CaptureFixture[str],
) -> None:
    @rejecting
    def command() -> None:
        first, bare, last = (UserError(word, file="a.nc") for word in ("first", "bare", "last"))
        first.excerpt, last.excerpt = "N10 X=", "N30 Z="
        first.further = (bare, last)
        raise first

    with pytest.raises(typer.Exit):
        command()
    assert capsys.readouterr().err.splitlines() == [
        "error: a.nc: first", "N10 X=", "error: a.nc: bare", "error: a.nc: last", "N30 Z=",
    ]  # fmt: skip


# What runs hand on


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What `run_campaign` is called with; `shown` is how its end is shown."""
    found: dict[str, Any] = {}

    def run_campaign(plans: Any, **given: Any) -> Any:
        found.update(given, plans=plans)
        return SimpleNamespace(exit_code=0)

    monkeypatch.setattr(f"{CAMPAIGN}.campaign.run_campaign", run_campaign)
    monkeypatch.setattr(
        f"{CAMPAIGN}.campaign.show_campaign", lambda _, talk: found.update(shown=talk)
    )
    return found


@pytest.mark.parametrize(
    ("options", "live"),
    [
        ((), None),
        (("--live",), (True, False)),
        (("--live-terminal",), (False, True)),
        (("--live", "--live-terminal"), (True, True)),
    ],
)
def test_a_live_view_is_shown_where_it_is_asked_for(
    options: tuple[str, ...],
    live: tuple[bool, bool] | None,
    asked: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Runs get its pipe, and it is open beside them; without one there is progress alone."""
    opened: list[Any] = []

    @contextmanager
    def beside(progress: Any) -> Any:
        opened.append(progress)
        yield

    def showing(_clock: Any, _put_out: Any, *, on_page: bool, in_terminal: bool) -> Watch:
        opened.append((on_page, in_terminal))
        return Watch(beside, Path("pipe"))

    monkeypatch.setattr("axisrig.bench.cli.beside.showing.showing", showing)
    monkeypatch.setattr("axisrig.bench.cli.beside.ticking.ticking", beside)
    assert call("run", "a.csv", *options) == 0
    watch = asked["watch"]
    with watch.beside("progress"):
        assert opened == (["progress"] if live is None else [live, "progress"])
    assert watch.live == (None if live is None else Path("pipe"))


def test_a_folder_is_gone_on_with_by_its_words_and_then_those_of_the_call(
    asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that the later change of an input is that of the call."""
    stored = ["p.csv", "-o", "out", "--set", "plc:V.E.A=1"]
    monkeypatch.setattr(f"{CAMPAIGN}.resuming.stored_arguments", lambda *_: stored)
    monkeypatch.setattr(sys, "argv", ["axisrig"])
    assert call("run", "-o", "out", "--resume", "--set", "plc:V.E.A=2") == 0
    assert asked["assignments"] == ["plc:V.E.A=1", "plc:V.E.A=2"]


def test_a_call_without_a_plan_names_what_is_missing(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("run", "-o", "out") == 2
    err = capsys.readouterr().err
    assert "no plan is named" in err
    assert "PLANS" in err.splitlines()[-1]


@pytest.mark.parametrize(("began_s", "ended_s", "words"), [(5.0, 8.0, "3 s"), (0.0, 61.0, "1 min")])
def test_a_judged_folder_says_how_long_it_took(
    began_s: float,
    ended_s: float,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    done = SimpleNamespace(results=[], left=[], report=Path("r.html"), exit_code=0)
    clock = iter([began_s, ended_s])
    monkeypatch.setattr(f"{CAMPAIGN}.rejudge.rejudge", lambda *_, **__: done)
    monkeypatch.setattr(f"{CAMPAIGN}.verdict_table.show_verdicts", lambda *_: None)
    monkeypatch.setattr(command_line, "time", SimpleNamespace(perf_counter=lambda: next(clock)))
    assert call("judge", "out", "--plan", "new.csv") == 0
    assert f"nothing ran in {words}" in capsys.readouterr().err


def test_the_begin_of_a_run_is_noted_in_utc_and_whole_seconds(asked: dict[str, Any]) -> None:
    assert call("run", "a.csv") == 0
    assert len(asked["started"]) == len("2026-01-01T00:00:00+00:00")
    assert asked["started"].endswith("+00:00")
