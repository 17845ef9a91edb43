"""Commands that hand their words on: what goes where, and with which code they end."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any

import pytest
import typer
from typer.testing import CliRunner

from axisrig.bench.cli import data_commands, list_commands
from axisrig.bench.cli.given import Given, given_options
from axisrig.bench.cli.main import app
from axisrig.bench.cli.nc_check import check_file
from axisrig.bench.tools.listings.language import language_listing
from axisrig.kernel.errors import UserError

LISTINGS: dict[str, tuple[str, tuple[Any, ...]]] = {
    "oracles": ("axisrig.bench.tools.listings.oracles.oracle_listing", ("probe",)),
    "drives": ("axisrig.bench.drive.cia402.dictionary.profiles.profile_listing", ("servo",)),
    "faults": ("axisrig.bench.rig.reading.faults.faults_table", ("bus",)),
    "explain": ("axisrig.bench.tools.listings.alarms.alarm_listing", ("50059",)),
    "errors": ("axisrig.bench.tools.listings.alarms.alarm_listing", ("probe", 3, "bus")),
    "metrics": ("axisrig.bench.tools.listings.metrics.metrics_table", ()),
    "objects": ("axisrig.bench.rig.cnc_objects.objects_table", ()),
    "language": ("axisrig.bench.tools.listings.language.language_listing", ("#MEAS",)),
}


@pytest.mark.parametrize("name", LISTINGS)
def test_a_listing_gets_the_words_of_its_command(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    function, words = LISTINGS[name]
    monkeypatch.setattr(function, lambda *given: f"<{given}>")
    command: Any = getattr(list_commands, name)
    command(*words)
    assert capsys.readouterr().out == f"<{words}>\n"


def test_a_page_is_written_as_it_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for room in ("alarms", "language"):
        monkeypatch.setattr(f"axisrig.bench.tools.listings.{room}.page", lambda: "# page\n")
    list_commands.errors(None, form="markdown")
    list_commands.language(None, markdown=True)
    assert capsys.readouterr().out == "# page\n# page\n"


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        (["so it is"], 0),
        (["LACKS it"], 1),
        (["LACKS it", "so it is"], 1),
        (["so it is", "LACKS it", "LACKS more", "so it is"], 1),
    ],
)
def test_the_doctor_ends_with_what_it_found(
    lines: list[str],
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("axisrig.bench.tools.listings.doctor.examine", lambda **_: iter(lines))
    with pytest.raises(typer.Exit) as caught:
        list_commands.doctor()
    assert caught.value.exit_code == code
    assert capsys.readouterr().out.splitlines() == lines


@pytest.mark.parametrize(
    ("found", "code", "errors"),
    [
        ({}, 0, []),
        ({"doubled": ["a"]}, 0, ["in several folders, with equal results: a"]),
        ({"missing": ["b", "c"]}, 4, ["missing: b", "missing: c"]),
        ({"bare": ["d"]}, 4, ["the trace or the file of the run is missing: d"]),
    ],
)
def test_a_merge_ends_by_what_it_lacks(
    found: dict[str, list[str]],
    code: int,
    errors: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked: dict[str, Any] = {}

    def merge(folders: list[Path], into: Path, **given: Any) -> SimpleNamespace:
        asked.update(given, folders=folders, into=into)
        known = {"doubled": [], "missing": [], "bare": [], "runs": 7, "statistics": 1}
        return SimpleNamespace(**{**known, **found}, report=into / "report.html")

    monkeypatch.setattr("axisrig.bench.campaign.sharing.merge", merge)
    with pytest.raises(typer.Exit) as caught:
        data_commands.merge([Path("one"), Path("two")], Path("out"), is_fresh=True)
    assert caught.value.exit_code == code
    out, err = capsys.readouterr()
    lost = len(found.get("missing", []))
    assert out.splitlines() == [
        f"7 runs and 1 row of statistics, {lost} missing", str(Path("out/report.html")),
    ]  # fmt: skip
    assert err.splitlines() == errors
    assert (asked["folders"], asked["into"], asked["is_fresh"]) == (
        [Path("one"), Path("two")], Path("out"), True,
    )  # fmt: skip
    assert callable(asked["build_report"])


def test_what_a_call_was_given_is_told_from_defaults() -> None:
    """Options that may come several times add to stored ones: they take nothing's place."""
    found: list[Given] = []
    app = typer.Typer()

    @app.command()
    def run(
        context: typer.Context,
        plan: str,
        jobs: Annotated[int, typer.Option("-j", "--jobs")] = 2,
        out: Annotated[str | None, typer.Option("-o", "--out")] = None,
        fresh: Annotated[bool, typer.Option("--fresh")] = False,
        changes: Annotated[list[str] | None, typer.Option("--set")] = None,
    ) -> None:
        found.append(given_options(context))

    def given(words: str) -> Given:
        assert CliRunner().invoke(app, words.split()).exit_code == 0
        return found.pop()

    plain = given("a.csv")
    assert not plain.options & {"-j", "--jobs", "-o", "--fresh", "--set"}
    assert plain.valued >= {"-j", "--jobs", "-o", "--out", "--set"}
    assert "--fresh" not in plain.valued
    whole = given("a.csv --jobs 3 --fresh --set a=1 --set b=2")
    assert whole.options >= {"-j", "--jobs", "--fresh"}
    assert not whole.options & {"-o", "--out", "--set"}
    words = whole.words[whole.words.index("a.csv") + 1 :]
    assert words == ["-j", "3", "--fresh", "--set", "a=1", "--set", "b=2"]


@pytest.mark.parametrize("words", [
    "-j auto", "--jobs auto", "-j 3", "-o out", "--out out", "-k words", "--timeout 5", "--isolate",
    "--call-timeout 7.5", "--set a=1 --set b=2", "--info serial=1", "--force", "--as-canopen",
    "--interface slcan", "--channel /dev/x", "--option a=1 --option b=2", "--bitrate 500000",
    "--segment can1", "-y", "--yes", "--bus-log asc,blf", "--fresh", "--full", "--resume",
    "--failed", "--shard 1/2", "--engine dask", "--scheduler tcp://h:1", "--live",
    "--live-terminal", "--strict", "-x", "-q", "-v",
])  # fmt: skip
def test_an_option_of_a_call_that_goes_on_means_the_same_again(words: str) -> None:
    """`axisrig run --resume -o DIR` calls itself with the words of this call."""
    run = typer.main.get_command(app).commands["run"]  # type: ignore[attr-defined]
    context = run.make_context("run", words.split())
    given = given_options(context)
    again = run.make_context("run", given.words)
    assert again.params == context.params
    (changed,) = [option for option in run.params if {*option.opts} & {*words.split()}]
    named = [
        option.name
        for option in run.params
        if again.get_parameter_source(option.name).name == "COMMANDLINE"
    ]
    assert named == [changed.name]


Check = Callable[[str], tuple[bool, str, str]]


@pytest.fixture
def check(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Check:
    def checked(text: str) -> tuple[bool, str, str]:
        program = tmp_path / "part.nc"
        program.write_text(text, encoding="utf-8")
        is_well = check_file(program, None)
        return is_well, *capsys.readouterr()

    return checked


@pytest.mark.parametrize(
    ("text", "errors", "counts"),
    [
        ("N10 G1 X1 F100\nN20 M30\n", [], "2 blocks, no errors, no notes"),
        ("N10 M30\n", [], "1 block, no errors, no notes"),
        ("N10 G1 X= F100\nN20 M30\n", ["part.nc:1:"], "2 blocks, 1 error, "),
        ("N10 G1 X=\nN20 G1 Y=\nN30 M30\n", ["part.nc:1:", "part.nc:2:"], "3 blocks, 2 errors, "),
        ("N10 L gone.nc\nN20 M30\n", ["part.nc:1:"], "2 blocks, 1 error, "),
        ("N10 L gone.nc\nN20 G1 X=\nN30 M30\n", ["part.nc:2:", "part.nc:1:"], "2 errors, "),
        ("N10 $GOTO N99\nN20 M30\n", ["part.nc:1:"], "2 blocks, 1 error, "),
    ],
)  # fmt: skip
def test_a_program_is_checked_to_its_end(
    check: Check, text: str, errors: list[str], counts: str
) -> None:
    is_well, out, err = check(text)
    assert is_well is not bool(errors)
    found = [line for line in err.splitlines() if line.startswith("error: ")]
    assert len(found) == len(errors)
    assert all(place in line for place, line in zip(errors, found, strict=True))
    lines = out.splitlines()
    assert lines[0].startswith("note: axes without --rig: X, Y, Z")
    assert counts in lines[-1]
    words = "the text is read; whether its values can be carried out shows in a run"
    assert (words in lines) is not bool(errors)


def test_words_of_the_language_are_found_by_their_meaning() -> None:
    """No name has this word in it."""
    found = language_listing("dwell time").splitlines()
    assert found[0].split() == ["G4", "dwell", "time"]
    with pytest.raises(UserError, match="no word fits"):
        language_listing("zebra")
