"""The line of a command says what it does and with what, before anything is read."""

import sys
from collections.abc import Callable
from typing import Any

import pytest
import typer

from axisrig.bench.cli.beside import waiting
from axisrig.bench.cli.main import app
from axisrig.kernel.errors import UserError

LINES = (
    ("run a.csv b.csv", "reading a.csv, b.csv"),
    ("demo", "looking for the models of the library in the cache"),
    ("judge out --plan p.csv", "judging the recordings of out"),
    ("nc a.nc --check", "checking a.nc"),
    ("nc a.nc --rig r.toml --check", "checking a.nc"),
    ("check a.csv r.toml", "checking a.csv, r.toml"),
    ("replay out p-a", "running p-a again"),
    ("drive r.toml", "making the drives of r.toml"),
    ("bus out p-a", "reading out"),
    ("budget p.csv -k row", "running row of p.csv with each cause of its error"),
    ("scenarios --machine gantry", "running scenarios of machine gantry"),
    ("report out", "writing the report of out"),
    ("export out --csv", "writing the series of out to out/export"),
    ("export out p-a --mf4 -o to", "writing the series of out to to"),
    ("query out select", "asking out"),
    ("sources out", "reading out"),
    ("merge a b -o c", "joining 2 folders"),
    ("diff a b", "comparing a and b"),
    ("trend a b c --metric m", "reading 3 folders"),
    ("params kp max", "reading kp max"),
    ("params --rig r.toml", "reading r.toml"),
    ("params --rig r.toml kp", "reading r.toml"),
    ("params diff a.lst b.lst", "reading diff a.lst b.lst"),
    ("doctor", "looking at this installation"),
    ("plan expand p.csv", "reading p.csv"),
    ("distance readings r.toml", "stepping each reading with r.toml"),
    ("tune distance --rig r.toml", "measuring the loop of r.toml"),
    ("rig from a.lst b.lst -o r.toml", "reading a.lst, b.lst"),
    ("rig export r.toml -o x.ssp", "packing the plants of r.toml"),
    ("perf", "timing the first row of testplans/latch_accuracy.csv"),
    ("perf --plan p.csv --case c", "timing c of p.csv"),
    ("fmu check a b", "trying out a, b"),
    ("fmu show a", "reading a"),
    ("fmu build", "looking for the models of the library in the cache"),
    ("fmu build own.mo", "looking for own.mo in the cache"),
    ("fmu build own.mo -o release", "building the release release"),
)


@pytest.fixture(scope="module")
def axisrig() -> Any:
    """The commands, made once."""
    return typer.main.get_command(app)


@pytest.fixture
def line_of(
    axisrig: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[str], str]:
    """Return the line of a call, and whether it moves; nothing is done."""

    def end(text: str, _clock: Any, *, is_terminal: bool) -> Any:
        raise UserError(f"{text}, {'moves' if is_terminal else 'stands'}")

    def line(words: str) -> str:
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
        with pytest.raises(SystemExit) as ended:
            axisrig.main(words.split())
        out, err = capsys.readouterr()
        assert (ended.value.code, out) == (2, "")
        return str(err.splitlines()[-1].removeprefix("error: "))

    monkeypatch.setattr(waiting, "_clocks", [lambda: 0.0])
    monkeypatch.setattr(waiting, "Waiting", end)
    return line


@pytest.mark.parametrize(("words", "text"), LINES)
def test_a_command_says_what_it_does_and_with_what(
    words: str, text: str, line_of: Callable[[str], str]
) -> None:
    assert line_of(words) == f"{text}, moves"


def test_beside_the_lines_of_a_program_nothing_moves(line_of: Callable[[str], str]) -> None:
    assert line_of("nc a.nc --rig r.toml") == "running a.nc on r.toml, stands"


def test_the_line_of_a_command_is_away_before_the_first_line_is_put_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And it does not come back for the others."""
    steps: list[str] = []

    class Shown:
        def __init__(self, text: str, *_: Any, **__: Any) -> None:
            steps.append(text)

        def inside(self, text: str) -> None: ...

        def tick(self) -> None: ...

        def end(self) -> None:
            steps.append("away")

    monkeypatch.setattr(waiting, "_clocks", [lambda: 0.0])
    monkeypatch.setattr(waiting, "Waiting", Shown)
    monkeypatch.setattr("builtins.print", lambda line, **_: steps.append(line))
    with waiting.waiting_for_line("making") as put_out:
        put_out("one")
        put_out("two")
    monkeypatch.undo()
    assert steps == ["making", "away", "one", "two"]
