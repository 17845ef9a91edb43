"""Options beside others of the same call: what is handed on, and what is printed where."""

import tomllib
from collections.abc import Callable, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest
import typer

from axisrig.bench.campaign.checking import plan_of
from axisrig.bench.campaign.resuming import GoingOn
from axisrig.bench.cli import (
    data_commands,
    fmu_commands,
    list_commands,
    params_command,
    tool_commands,
)
from axisrig.bench.cli.nc_check import check_file
from axisrig.kernel.errors import UserError

CAMPAIGN, TOOLS, RESULTS = "axisrig.bench.campaign", "axisrig.bench.tools", "axisrig.results"
ROOT = Path(__file__).parents[2]


def code_of(command: Callable[[], None]) -> int:
    """Return the exit code of a command."""
    try:
        command()
    except typer.Exit as ended:
        return ended.exit_code
    return 0


# Reports, queries, comparisons


def test_a_report_says_beside_its_path_what_it_leaves_out(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def build(folder: Path, *, is_full: bool, put_out: Callable[[str], None]) -> Path:
        put_out(f"{folder} {is_full}")
        return Path("r.html")

    monkeypatch.setattr(f"{CAMPAIGN}.results.folder.recover", lambda _: None)
    monkeypatch.setattr("axisrig.reports.build.build_report", build)
    data_commands.report(Path("out"), is_full=True)
    assert capsys.readouterr() == ("r.html\n", "out True\n")


FOUND = pd.DataFrame({"run": ["a", "b"], "value": [1.5, None]})


@pytest.fixture
def query(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    asked: list[Any] = []
    monkeypatch.setattr(f"{RESULTS}.loading.load", lambda folder: f"of {folder}")
    monkeypatch.setattr(f"{RESULTS}.query.query", lambda *words: asked.append(words) or FOUND)
    return asked


def test_a_table_of_a_query_has_no_numbers_of_rows_and_nothing_where_nothing_is(
    query: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    data_commands.query(Path("out"), "select 1")
    head, one, other, *more = capsys.readouterr().out.split("\n")
    assert (head.split(), one.split(), other.split(), more) == (
        ["run", "value"], ["a", "1.5"], ["b"], [""],
    )  # fmt: skip
    assert query == [("of out", "select 1")]


def test_csv_of_a_query_ends_with_its_last_row(
    query: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    data_commands.query(Path("out"), "select 1", csv=True)
    assert capsys.readouterr().out == "run,value\na,1.5\nb,\n"


@pytest.mark.parametrize(
    ("command", "place", "package"),
    [
        (lambda: data_commands.query(Path("out"), "select 1"), "query.query", "duckdb"),
        (lambda: data_commands.export(Path("out"), mf4=True), "export.export", "asammdf"),
    ],
)
def test_a_library_that_is_missing_comes_with_an_extra_that_is_there(
    command: Callable[[], None],
    place: str,
    package: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The extra of the hint is one of pyproject.toml and brings this library."""

    def lacks(*_: Any) -> None:
        raise ImportError(package)

    monkeypatch.setattr(f"{RESULTS}.loading.load", lambda folder: folder)
    monkeypatch.setattr(f"{RESULTS}.{place}", lacks)
    assert code_of(command) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"error: {package} is not installed; pip install 'axisrig[")
    extra = err.partition("axisrig[")[2].partition("]")[0]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert any(text.startswith(package) for text in project["optional-dependencies"][extra])


def folder_of(path: Path) -> Any:
    """Results of a folder; the run of `odd` was altered."""
    is_odd = path.name.startswith("odd")
    run = SimpleNamespace(run=f"{path}-a", altered=is_odd, altered_words="has other files")
    return SimpleNamespace(folder=path, runs=[run, SimpleNamespace(altered=False)])


@pytest.mark.parametrize(
    ("folders", "altered"),
    [("a b", ()), ("odd b", ("odd",)), ("a odd", ("odd",)), ("odd odd2", ("odd", "odd2"))],
)
def test_a_comparison_names_what_was_altered_in_either_folder(
    folders: str,
    altered: Sequence[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What has changed alone ends with 0; the page has the folders in the order of the call."""
    pages: list[Any] = []
    found = SimpleNamespace(pairs="pairs", worse=lambda: False)
    monkeypatch.setattr(f"{RESULTS}.compare.pairs.compare", lambda *_: found)
    monkeypatch.setattr(f"{RESULTS}.compare.changes.changes", lambda *_: ["a change"])
    monkeypatch.setattr(f"{RESULTS}.compare.words.diff_lines", lambda *_: ["line"])
    monkeypatch.setattr(f"{RESULTS}.compare.page.write_diff", lambda *words: pages.append(words))
    # The last one: what is imported for the others has its own
    monkeypatch.setattr(f"{CAMPAIGN}.results.stored.read_results", folder_of)
    before, after = map(Path, folders.split())
    assert code_of(lambda: data_commands.diff(before, after, Path("d.html"))) == 0
    out, err = capsys.readouterr()
    assert out == "line\nd.html\n"
    assert err == "".join(f"{name}: {name}-a: has other files\n" for name in altered)
    ((_, page, folders_of_page, changed),) = [(w[0], w[1], w[2], w[3]) for w in pages]
    assert (page, changed) == (found, ["a change"])
    assert [one.folder for one in folders_of_page] == [before, after]


def test_the_page_of_a_trend_is_named_behind_its_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(f"{RESULTS}.compare.trend.trend", lambda *_: "found")
    monkeypatch.setattr(f"{RESULTS}.compare.words.trend_lines", lambda _: ["one", "two"])
    monkeypatch.setattr(f"{RESULTS}.compare.page.write_trend", lambda path, _: path)
    monkeypatch.setattr(f"{CAMPAIGN}.results.stored.read_results", lambda folder: folder)
    data_commands.trend([Path("a")], "m", None, Path("t.html"))
    assert capsys.readouterr().out == "one\ntwo\nt.html\n"


def test_joined_folders_have_the_time_of_the_call(monkeypatch: pytest.MonkeyPatch) -> None:
    """In UTC and whole seconds, as the folders of `axisrig run` have."""
    given: dict[str, Any] = {}

    def merge(*_: Any, **more: Any) -> Any:
        given.update(more)
        return SimpleNamespace(doubled=[], missing=[], bare=[], runs=1, statistics=0, report="r")

    monkeypatch.setattr(f"{CAMPAIGN}.sharing.merge", merge)
    assert code_of(lambda: data_commands.merge([Path("a")], Path("out"))) == 0
    started = datetime.fromisoformat(given["started"])
    assert (started.utcoffset(), started.microsecond) == (timedelta(0), 0)
    assert len(given["started"]) == len("2026-01-01T00:00:00+00:00")
    assert abs(datetime.now(UTC) - started) < timedelta(minutes=1)
    assert given["is_fresh"] is False


# Tools


@pytest.mark.parametrize("given", [None, Path("own.toml")])
def test_a_rig_that_is_named_for_a_log_takes_the_place_of_the_stored_one(
    given: Path | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Any] = []
    monkeypatch.setattr(f"{TOOLS}.bus_log.bus_log.find_log", lambda *_: ([Path("log")], "stored"))
    monkeypatch.setattr("axisrig.bench.rig.reading.file.read_rig", lambda path: (path, "files"))
    monkeypatch.setattr("axisrig.bench.rig.settings.read_settings", lambda *words: words)
    monkeypatch.setattr(
        f"{TOOLS}.bus_log.bus_log.tell_log", lambda *words: shown.append(words) or ()
    )
    tool_commands.bus(
        Path("out"), "p-a", given, ["SDO, Z", " ", "6041,,X "], ["1=can1", "2=can2"], 5.0
    )
    ((_, settings, chosen, _),) = shown
    assert settings == ("stored" if given is None else (given, "files", []))
    assert chosen.only == ("SDO", "Z", "6041", "X")
    assert dict(chosen.segments) == {"1": "can1", "2": "can2"}
    assert (chosen.from_ms, chosen.to_ms, chosen.is_all) == (5.0, float("inf"), False)


@pytest.mark.parametrize("carrier", ["can", "ethercat"])
def test_a_new_project_is_on_its_carrier_and_says_what_is_next(
    carrier: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(f"{TOOLS}.project.new.PLAN", "own.csv")
    monkeypatch.setattr(f"{TOOLS}.project.new.new_project", lambda *words: words)
    tool_commands.new(Path("mine"), carrier)
    assert capsys.readouterr() == (
        f"mine\n{carrier}\n", "next: cd mine; axisrig run own.csv\n",
    )  # fmt: skip


@pytest.fixture
def budgets(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What a budget is made of."""
    asked: dict[str, Any] = {}

    def with_inputs(given: Any, select: str) -> Any:
        asked.update(columns=[one.column for one in given], select=select)
        return SimpleNamespace(cases="cases")

    plan = SimpleNamespace(with_inputs=with_inputs)
    monkeypatch.setattr("axisrig.bench.plan.plan.read_plan", lambda _: plan)
    monkeypatch.setattr("axisrig.bench.plan.select.only", lambda *_: "the case")
    monkeypatch.setattr(f"{CAMPAIGN}.processes.usable_cores", lambda: 5)
    monkeypatch.setattr(
        f"{TOOLS}.budget.budget.make_budget",
        lambda case, axis, run, combinations: asked.update(
            case=case, axis=axis, jobs=run.keywords["jobs"], combinations=combinations
        ),
    )
    monkeypatch.setattr(f"{TOOLS}.budget.words.budget_lines", lambda _: ["one", "two"])
    return asked


@pytest.mark.parametrize(("jobs", "used"), [(0, 5), (1, 1), (3, 3)])
def test_a_budget_takes_each_change_and_the_cores_that_may_be_used(
    jobs: int, used: int, budgets: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    tool_commands.budget(
        Path("p.csv"), "row", None, ["plant:z.kv=4", "plc:V.E.A=1"], None, 64, jobs
    )
    assert budgets == {
        "columns": ["plant:z.kv", "plc:V.E.A"], "select": "row", "case": "the case", "axis": None,
        "jobs": used, "combinations": 64,
    }  # fmt: skip
    assert capsys.readouterr().out == "one\ntwo\n"


@pytest.mark.parametrize("is_building", [False, True])
def test_the_doctor_builds_only_where_asked(
    is_building: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        f"{TOOLS}.listings.doctor.examine", lambda *, is_building: [f"ok {is_building}"]
    )
    assert code_of(lambda: list_commands.doctor(is_building=is_building)) == 0
    assert capsys.readouterr().out == f"ok {is_building}\n"


@pytest.mark.parametrize("out", [None, Path("release")])
def test_every_model_and_one_of_them_exclude_each_other(
    out: Path | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for place in ("release.release_models", "library.build_models"):
        monkeypatch.setattr(f"{TOOLS}.fmu.{place}", pytest.fail)
    assert code_of(lambda: fmu_commands.build("own.mo", is_all=True, out=out)) == 2
    assert capsys.readouterr().err == (
        "error: --all is every model: leave it out, or the model; found 'own.mo'\n"
    )


@pytest.mark.parametrize("more", [{"rig": Path("r.toml")}, {"axis": "Z"}, {"sets": ["set:Z.a=1"]}])
def test_two_lists_are_compared_with_nothing_else(more: dict[str, Any]) -> None:
    given: Any = {"rig": None, "axis": None, "sets": []} | more
    with pytest.raises(UserError, match="takes two lists or two rigs and nothing else"):
        params_command._answer(
            ["diff", "a", "b"], given["rig"], given["axis"], "text", given["sets"]
        )


def test_a_folder_that_is_named_as_a_word_is_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`axisrig params lists` beside a folder `lists` looks for the word."""
    (tmp_path / "lists").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(f"{TOOLS}.params.listing.parameters_text", lambda *words: f"{words}")
    assert params_command._answer(["lists"], None, None, "csv", []) == ("(['lists'], 'csv')", 0)


def test_words_that_a_rig_passes_over_have_to_be_words_of_the_language(tmp_path: Path) -> None:
    """A check of a program reads them as a run does."""
    program, rig = tmp_path / "a.nc", tmp_path / "rig.toml"
    program.write_text("N10 M30\n", encoding="utf-8")
    base = ROOT / "testplans" / "rigs" / "probe-xyz.toml"
    rig.write_text(
        f'base = "{base.as_posix()}"\n[language]\npass_over = ["#TIMRE"]\n', encoding="utf-8"
    )
    with pytest.raises(UserError, match="#TIMRE"):
        check_file(program, rig)


@pytest.mark.parametrize("name", ["p.csv", "p.CSV", "p.xlsx", "p.Ods", "p.PARQUET"])
def test_a_table_is_a_plan_whatever_its_suffix_is_written_like(name: str, tmp_path: Path) -> None:
    """One that is not there is refused as a plan; a folder of that name is none."""
    with pytest.raises(UserError) as caught:
        plan_of(tmp_path / name)
    assert caught.value.file == str(tmp_path / name)
    (tmp_path / name).mkdir()
    assert plan_of(tmp_path / name) is None
    assert plan_of(tmp_path / "r.toml") is None


@pytest.mark.parametrize(
    ("resumed", "failed", "fresh", "found"),
    [
        (False, False, False, GoingOn.NO), (True, False, False, GoingOn.MISSING),
        (False, True, False, GoingOn.FAILED), (False, False, True, GoingOn.NO),
        (True, True, False, "--resume and --failed exclude each other"),
        (True, False, True, "--fresh removes the results that --resume and --failed keep"),
        (False, True, True, "--fresh removes the results that --resume and --failed keep"),
        (True, True, True, "--resume and --failed exclude each other"),
    ],
)  # fmt: skip
def test_ways_to_go_on_exclude_each_other(
    resumed: bool, failed: bool, fresh: bool, found: GoingOn | str
) -> None:
    given = {"is_resumed": resumed, "is_failed": failed, "is_fresh": fresh}
    if isinstance(found, GoingOn):
        assert GoingOn.of(**given) is found
        return
    with pytest.raises(UserError, match=found):
        GoingOn.of(**given)
