"""What a call was given beside its plan: the words that stay when a folder is gone on with."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import pytest
import typer

from axisrig.bench.campaign.resuming import _without
from axisrig.bench.cli.beside.waiting import Waiting
from axisrig.bench.cli.given import Given, given_options
from axisrig.bench.cli.main import app


@cache
def command() -> Any:
    """`axisrig run`, which takes long to make."""
    whole: Any = typer.main.get_command(app)
    return whole.commands["run"]


def given(text: str) -> Given:
    """Of a call without a plan and with these words; nothing is run."""
    return given_options(command().make_context("run", text.split()))


@pytest.mark.parametrize(
    ("text", "words", "options"),
    [
        ("", [], set()),
        ("-o out", ["-o", "out"], {"-o", "--out"}),
        ("--out out", ["-o", "out"], {"-o", "--out"}),
        ("--out=out", ["-o", "out"], {"-o", "--out"}),
        ("-j 3", ["-j", "3"], {"-j", "--jobs"}),
        ("--jobs auto", ["-j", "auto"], {"-j", "--jobs"}),
        ("-x", ["-x"], {"-x", "--exitfirst"}),
        ("--exitfirst", ["-x"], {"-x", "--exitfirst"}),
        ("--resume", ["--resume"], {"--resume"}),
        ("--yes", ["--yes"], {"--yes", "-y"}),
        ("--timeout 5", ["--timeout", "5.0"], {"--timeout"}),
        # What may come several times adds to what the folder has
        ("--set a=1 --set b=2", ["--set", "a=1", "--set", "b=2"], set()),
        ("--info serial=1", ["--info", "serial=1"], set()),
    ],
)
def test_an_option_of_a_call_takes_the_place_of_a_stored_one_under_each_name(
    text: str, words: list[str], options: set[str]
) -> None:
    found = given(text)
    assert found.words == words
    assert found.options == options


def test_options_with_a_value_are_known_by_each_of_their_names() -> None:
    """So that the value goes with its option when that is left out."""
    valued = given("").valued
    assert {
        "-o",
        "--out",
        "-j",
        "--jobs",
        "-k",
        "--set",
        "--info",
        "--timeout",
        "--shard",
    } <= valued
    assert valued.isdisjoint(
        {"--resume", "--failed", "--fresh", "-x", "--exitfirst", "-q", "--yes"}
    )


@pytest.mark.parametrize("stored", ["-o old", "--out old", "--out=old", "-oold"])
@pytest.mark.parametrize("text", ["-o new", "--out=new"])
def test_a_stored_folder_gives_way_whatever_its_option_is_called(stored: str, text: str) -> None:
    found = given(text)
    words = ["p.csv", *stored.split(), "--set", "a=1"]
    assert _without(words, found.options, found.valued) == ["p.csv", "--set", "a=1"]


@pytest.mark.parametrize("stored", ["-j 4", "--jobs 4", "--jobs=4", "-j4", "-x", "--exitfirst"])
def test_what_this_call_does_not_name_stays_with_its_value(stored: str) -> None:
    found = given("-o new")
    words = ["p.csv", *stored.split(), "-k", "probe"]
    assert _without(words, found.options, found.valued) == words


def test_a_line_that_has_given_way_counts_anew(capsys: pytest.CaptureFixture[str]) -> None:
    """The time of the runs is that of their own lines."""
    now_s = [0.0]
    line = Waiting("reading p.csv", lambda: now_s[0], is_terminal=False)

    def wait(seconds: int) -> None:
        for _ in range(seconds):
            now_s[0] += 1.0
            line.tick()

    @contextmanager
    def runs(of: str) -> Iterator[None]:
        assert of == "progress"
        wait(95)
        yield

    wait(20)
    with line.beside(runs, "progress"):
        wait(100)
    line.say("writing the report")
    wait(65)
    assert capsys.readouterr().err.splitlines() == [
        "reading p.csv", "writing the report, 30 s", "writing the report, 60 s",
    ]  # fmt: skip
