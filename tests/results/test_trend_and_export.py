"""Trends that are refused, and files of runs for other programs."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError
from axisrig.results.compare.trend import trend
from axisrig.results.export import export, export_diagnosis


def campaign(name: str, *rows: tuple[str, str, str, str, str], started: str = "") -> Any:
    """rows: case, metric, value, upper limit, verdict."""
    runs = [
        SimpleNamespace(
            run=f"p-{case}-{number}",
            case={"plan": "p", "case": case},
            is_statistic=False,
            checks=[CheckRow(metric, value=value, unit="um", upper=upper, verdict=verdict)],
        )
        for number, (case, metric, value, upper, verdict) in enumerate(rows)
    ]  # fmt: skip
    return SimpleNamespace(folder=Path(name), manifest={"started": started}, planned=runs)


FIRST = campaign(
    "one", ("a", "m", "1", "9", "pass"), ("a", "m", "3", "9", "marginal"),
    ("b", "m", "5", "7", "pass"), ("a", "m", "inf", "9", "fail"), started="monday",
)  # fmt: skip
LAST = campaign("two", ("a", "m", "4", "8", "fail"), ("a", "other", "4", "6", "error"),
                ("a", "m", "", "", "error"), started="friday")  # fmt: skip


def test_a_trend_follows_each_case_through_the_folders_that_have_it() -> None:
    found = trend([FIRST, LAST], "m")
    assert (found.folders, found.starts) == (("one", "two"), ("monday", "friday"))
    a, b = found.cases
    assert (a.case, a.limits, b.case, b.limits) == ("p-a", (), "p-b", (7.0,))
    first, last = a.points
    assert (first.place, first.n, first.mean, first.verdict) == (0, 2, 2.0, Verdict.MARGINAL)
    assert first.spread == pytest.approx(2.0**0.5)
    assert (last.place, last.n, last.mean, last.verdict) == (1, 1, 4.0, Verdict.FAIL)
    assert last.spread != last.spread
    assert [(one.place, one.n) for one in b.points] == [(0, 1)]
    # A folder without the case keeps its place
    a, b = trend([FIRST, campaign("none", ("c", "other", "1", "9", "pass")), LAST], "m").cases
    assert [(one.place, one.mean) for one in a.points] == [(0, 2.0), (2, 4.0)]
    assert [one.place for one in trend([LAST, FIRST], "m", "b").cases[0].points] == [1]
    for case in ("a", "p-a"):
        assert [one.case for one in trend([FIRST, LAST], "m", case).cases] == ["p-a"]


@pytest.mark.parametrize(
    ("metric", "case", "words", "value", "allowed"),
    [
        ("mm", None, "no folder checks this metric", "mm", "m"),
        ("mm", "a", "no folder checks this metric", "mm", "m"),
        ("far_from_any", None, "no folder checks this metric", "far_from_any", "m, other"),
        ("m", "c", "no folder has such values", "m of c", None),
        ("m", "p-c", "no folder has such values", "m of p-c", None),
    ],
)
def test_a_trend_of_nothing_says_what_there_is(
    metric: str, case: str | None, words: str, value: str, allowed: str | None
) -> None:
    with pytest.raises(UserError) as caught:
        trend([FIRST, LAST], metric, case)
    error = caught.value
    assert (error.message, error.value, error.allowed) == (words, value, allowed)


def test_a_metric_without_a_value_is_known() -> None:
    empty = campaign("one", ("a", "m", "", "", "error"))
    with pytest.raises(UserError) as caught:
        trend([empty], "m")
    assert (caught.value.message, caught.value.value) == ("no folder has such values", "m")


class Stored:
    """Two runs with a signal, one of which has diagnosis data."""

    def traces(self) -> dict[str, None]:
        return {"r1": None, "r2": None}

    def signals(self, run: str) -> pd.DataFrame:
        table = pd.DataFrame({"time_ns": [0, 1_000_000], "Z.set_mm": [0.5, 0.25],
                              "Z.word": ["a", "b"]})  # fmt: skip
        table.attrs.update(units={"time_ns": "ns", "Z.set_mm": "mm"}, run=run)
        return table

    def diagnosis(self, _run: str) -> pd.DataFrame:
        table = pd.DataFrame({"time_ns": [0, 2_500_000], "zstd": ["A", "B"], "kp": [1, 2],
                              "cmd_offset": [3, 4]})  # fmt: skip
        table.attrs["decoder"] = {"dist_ctrl": "on"}
        return table


Write = Callable[..., list[Path]]


@pytest.mark.parametrize(("runs", "names"), [((), ["r1", "r2"]), (("r2",), ["r2"])])
def test_a_file_for_each_run_or_for_those_that_are_named(
    tmp_path: Path, runs: tuple[str, ...], names: list[str]
) -> None:
    results: Any = Stored()
    for into in (tmp_path / "new" / "folder", tmp_path):
        paths = [*export(results, runs, into, "csv")]
        assert paths == [into / f"{name}.csv" for name in names]
        assert paths[0].read_bytes() == (
            b"time_ns,Z.set_mm,Z.word\nns,mm,\n0,0.5,a\n1000000,0.25,b\n"
        )
        texts = [*export_diagnosis(results, runs, into)]
        assert texts == [into / f"{name}.diag_data.txt" for name in names]


def test_diagnosis_data_have_their_heads_and_instants(tmp_path: Path) -> None:
    results: Any = Stored()
    (path, _) = export_diagnosis(results, (), tmp_path)
    assert path.read_text(encoding="utf-8").splitlines() == [
        "DECODER : CONFIGURATION CHANNEL-NO.: 1",
        f"  {'dist_ctrl':<44}on",
        "# SYNC 0 ms",
        "Distance Control:",
        f"  {'zstd:':<24}A",
        f"  {'kp:':<24}1",
        "Dist-Ctrl Interface:",
        f"  {'cmd_offset:':<24}3",
        "# SYNC 2.5 ms",
        "Distance Control:",
        f"  {'zstd:':<24}B",
        f"  {'kp:':<24}2",
        "Dist-Ctrl Interface:",
        f"  {'cmd_offset:':<24}4",
    ]


class Different(Stored):
    """Runs that each have a table and a decoder of their own."""

    def signals(self, run: str) -> pd.DataFrame:
        table = pd.DataFrame({"time_ns": [0], f"{run}.set_mm": [float(run[1:])]})
        table.attrs.update(units={f"{run}.set_mm": run}, run=run)
        return table

    def diagnosis(self, run: str) -> pd.DataFrame:
        table = pd.DataFrame({"time_ns": [0], "zstd": [f"state of {run}"]})
        table.attrs["decoder"] = {f"of_{run}": run}
        return table


@pytest.mark.parametrize("runs", [(), ("r1", "r2"), ("r2", "r1"), ("r2",)])
def test_a_file_has_what_its_own_run_left_and_nothing_of_the_others(
    tmp_path: Path, runs: tuple[str, ...]
) -> None:
    """However many are written, in whichever order; without a name all of them."""
    results: Any = Different()
    named = list(runs) or ["r1", "r2"]
    paths = list(export(results, runs, tmp_path, "csv"))
    assert [path.stem for path in paths] == named
    for path, run in zip(paths, named, strict=True):
        assert path.read_text(encoding="utf-8").splitlines() == [
            f"time_ns,{run}.set_mm", f",{run}", f"0,{float(run[1:])}",
        ]  # fmt: skip
    texts = list(export_diagnosis(results, runs, tmp_path))
    assert [path.name.partition(".")[0] for path in texts] == named
    for path, run in zip(texts, named, strict=True):
        assert path.read_text(encoding="utf-8").splitlines() == [
            "DECODER : CONFIGURATION CHANNEL-NO.: 1",
            f"  {f'of_{run}':<44}{run}",
            "# SYNC 0 ms",
            "Distance Control:",
            f"  {'zstd:':<24}state of {run}",
        ]


def test_truth_values_are_signals_and_texts_are_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asammdf = pytest.importorskip("asammdf", reason="the extra `mdf` is not installed")
    table = pd.DataFrame({"time_ns": [0, 1_000_000, 2_500_000], "Z.set_mm": [0.5, 0.25, -1.0],
                          "Z.edge": [True, False, True], "Z.count": [3, 2, 1],
                          "Z.word": ["a", "b", "c"]})  # fmt: skip
    table.attrs.update(units={"time_ns": "ns", "Z.set_mm": "mm"}, rig="r.toml")
    results: Any = SimpleNamespace(traces=lambda: {"r": None}, signals=lambda _: table)
    (path,) = export(results, (), tmp_path, "mf4")
    with asammdf.MDF(path) as mdf:
        found = {channel.name: mdf.get(channel.name) for channel in mdf.iter_channels()}
        assert set(found) - {"time", "t"} == {"Z.set_mm", "Z.edge", "Z.count"}
        for name, values in (("Z.set_mm", [0.5, 0.25, -1.0]), ("Z.edge", [1, 0, 1]),
                             ("Z.count", [3, 2, 1])):  # fmt: skip
            assert found[name].samples.tolist() == values
            assert found[name].timestamps.tolist() == [0.0, 0.001, 0.0025]
            assert found[name].unit == ("mm" if name == "Z.set_mm" else "")
        assert found["Z.edge"].samples.dtype == "uint8"
        assert [group.channel_group.comment for group in mdf.groups] == ["run r, rig r.toml"]
        assert mdf.start_time.timestamp() == 0.0
