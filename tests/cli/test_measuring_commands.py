"""`axisrig perf`, `tune distance`, `rig export`, `query`: what is measured and what is printed."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

from axisrig.bench.campaign import checking, processes
from axisrig.bench.tools.perf import gains, perf, profile, stages
from axisrig.kernel.errors import UserError

Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def apart(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What was to be done in a process apart; nothing is."""
    asked: list[Any] = []

    def do(function: Any, *words: Any, **how: Any) -> Any:
        asked.append((function, words, how))
        return {"one": 1} if function is not profile.profile_row else "the profile"

    monkeypatch.setattr(processes, "do_apart", do)
    monkeypatch.setattr(checking, "plan_of", lambda path: f"plan {path}")
    monkeypatch.setattr(checking, "rigs_of", lambda path, plan: [f"rigs of {plan}"])
    monkeypatch.setattr(stages, "show_stages", lambda result: f"stages {result}")
    monkeypatch.setattr(perf, "show", lambda result, as_json: f"{result} {as_json}")
    monkeypatch.setattr(gains, "read_result", lambda path: {"before": str(path)})
    monkeypatch.setattr(gains, "gains", lambda result, before: [result["one"], before])
    monkeypatch.setattr(gains, "show_gains", lambda _result, before: f"against {before}")
    return asked


def test_the_stages_of_a_next_run_are_printed_or_one_object(
    axisrig: Call, apart: list[Any]
) -> None:
    words = ("perf", "--stages", "--plan", "p.csv", "--case", "c", "--repeats", "3")
    assert axisrig(*words)[:2] == (0, "stages {'one': 1}\n")
    code, out, _ = axisrig(*words, "--json")
    assert (code, json.loads(out)) == (0, {"one": 1})
    function, given, how = apart[0]
    assert function is stages.measure_stages
    assert given[:3] == (Path("p.csv"), "c", 3)
    assert how == {"rigs": ["rigs of plan p.csv"], "file": Path("p.csv")}


def test_a_row_is_measured_and_compared_where_asked(axisrig: Call, apart: list[Any]) -> None:
    words = ("perf", "--plan", "p.csv")
    assert axisrig(*words)[:2] == (0, "{'one': 1} False\n")
    assert apart[0][0] is perf.measure
    assert apart[0][1][:3] == (Path("p.csv"), None, 5)
    assert axisrig(*words, "--json")[1] == "{'one': 1} True\n"
    against = {"before": "b.json"}
    assert axisrig(*words, "--against", "b.json")[1] == (
        f"{{'one': 1}} False\n\nagainst {against}\n"
    )
    assert axisrig(*words, "--against", "b.json", "--json")[1] == (
        f"{ {'one': 1, 'gains': [1, against]} } True\n"
    )


def test_a_profile_is_that_of_one_run(axisrig: Call, apart: list[Any]) -> None:
    assert axisrig("perf", "--profile", "--plan", "p.csv", "--case", "c")[:2] == (
        0, "the profile\n",
    )  # fmt: skip
    assert apart[0][1][:2] == (Path("p.csv"), "c")
    assert axisrig("perf", "--profile", "--against", "b.json")[0] == 2


def test_a_loop_is_measured_and_drawn(
    axisrig: Call, apart: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The picture is named by the axis unless a name is given; warnings are beside the result."""
    asked: dict[str, Any] = {}
    tune = "axisrig.bench.tools.tune"
    bench = SimpleNamespace(axis="Y")
    monkeypatch.setattr(f"{tune}.measure.choose", lambda *given: asked.update(given=given) or bench)
    picture = SimpleNamespace(  # without what it draws with, which takes long to load
        kind_of=lambda path: path, draw=lambda _, path: asked.update(drawn=path)
    )
    monkeypatch.setitem(sys.modules, f"{tune}.picture", picture)  # type: ignore[arg-type]
    monkeypatch.setattr(f"{tune}.report.text_of", lambda found: f"text {found}")
    monkeypatch.setattr(f"{tune}.report.data_of", lambda found: found)
    monkeypatch.setattr(f"{tune}.report.warnings_of", lambda _: ["first", "second"])
    code, out, err = axisrig("tune", "distance", "--rig", "r.toml")
    assert (code, out) == (0, "text {'one': 1}\n")
    assert err.splitlines() == ["warning: first", "warning: second", "tune-Y.svg"]
    assert asked == {"given": (Path("r.toml"), None, None, []), "drawn": Path("tune-Y.svg")}
    options = "--axis Z --variable V.E.D --step 0.05 --picture p.png --set plant:z.kv=4 --json"
    code, out, err = axisrig("tune", "distance", "--rig", "r.toml", *options.split())
    assert (json.loads(out), err.splitlines()[-1]) == ({"one": 1}, "p.png")
    assert asked["given"] == (Path("r.toml"), "Z", "V.E.D", ["plant:z.kv=4"])
    assert apart[1][1:] == ((bench, 0.05), {"rigs": [Path("r.toml")], "file": Path("r.toml")})


@pytest.mark.parametrize(
    ("options", "target", "fmi"),
    [((), "r.ssp", "2.0"), (("-o", "to/x.ssp", "--fmi", "3.0"), "to/x.ssp", "3.0")],
)
def test_the_package_of_a_rig_is_written_here_unless_named(
    axisrig: Call, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], target: str, fmi: str
) -> None:
    """What cannot be exported is written to stderr."""
    asked: list[Any] = []

    def export(settings: Any, path: Path, version: str) -> list[str]:
        asked.append((settings, path, version))
        return ["plant a stays"]

    rooms = "axisrig.bench"
    monkeypatch.setattr(f"{rooms}.rig.contents.settings_of", lambda rig, sets: (rig, sets))
    monkeypatch.setattr(f"{rooms}.tools.rig_export.package.export_rig", export)
    rig = Path("machines/r.toml")
    code, out, err = axisrig("rig", "export", rig, *options, "--set", "plant:z.kv=4")
    assert (code, out, err) == (0, f"{target}\n", "plant a stays\n")
    assert asked == [((rig, ["plant:z.kv=4"]), Path(target), fmi)]


def test_the_answer_of_a_query_is_a_table_or_csv(
    axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = pd.DataFrame({"run": ["a", "b"], "value": [1.5, None]})
    monkeypatch.setattr("axisrig.results.loading.load", lambda folder: folder)
    monkeypatch.setattr("axisrig.results.query.query", lambda results, sql: found)
    code, out, _ = axisrig("query", "out", "select 1")
    assert (code, out.split()) == (0, ["run", "value", "a", "1.5", "b"])
    assert axisrig("query", "out", "select 1", "--csv")[1] == "run,value\na,1.5\nb,\n"

    def lacks(*_: Any) -> None:
        raise ImportError("duckdb")

    monkeypatch.setattr("axisrig.results.query.query", lacks)
    code, _, err = axisrig("query", "out", "select 1")
    assert code == 2
    assert "duckdb is not installed" in err
    assert "pip install 'axisrig[query]'" in err


def test_what_is_no_query_is_refused_with_its_message(
    axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> None:
        raise UserError("a query is one statement that selects")

    monkeypatch.setattr("axisrig.results.loading.load", lambda folder: folder)
    monkeypatch.setattr("axisrig.results.query.query", refuse)
    code, out, err = axisrig("query", "out", "drop table cases")
    assert (code, out) == (2, "")
    assert "a query is one statement that selects" in err
