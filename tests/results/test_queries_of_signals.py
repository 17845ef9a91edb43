"""Signals of several runs in one query: wherever their files are, whatever columns they have."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from axisrig.kernel.errors import UserError
from axisrig.results.query import query

pytest.importorskip("duckdb", reason="the extra `query` is not installed")


def results(folder: Path, **runs: dict[str, list[float]]) -> Any:
    """A folder whose runs have these signals, a row each ns."""
    folder.mkdir(parents=True)
    paths = {}
    for run, columns in runs.items():
        rows = len(next(iter(columns.values())))
        paths[run] = folder / f"{run}.parquet"
        pq.write_table(pa.table({"time_ns": list(range(rows)), **columns}), paths[run])
    cases = pd.DataFrame({"run": list(runs), "verdict": ["pass"] * len(runs)})
    checks = pd.DataFrame({"run": list(runs), "metric": ["m"] * len(runs)})
    return SimpleNamespace(cases=cases, checks=checks, traces=lambda: paths)


@pytest.mark.parametrize("name", ["plain", "it's here", "''", "a b; c", "\u00e4 %20"])
def test_a_folder_may_have_any_name(tmp_path: Path, name: str) -> None:
    """A quote in it ends no text of a statement."""
    found = results(tmp_path / name, a={"Z.set_mm": [1.0, 2.0]}, b={"Z.set_mm": [5.0]})
    table = query(found, 'select run, max("Z.set_mm") as most from signals group by run order by 1')
    assert table.to_dict("list") == {"run": ["a", "b"], "most": [2.0, 5.0]}


def test_a_signal_that_a_run_lacks_is_empty_there(tmp_path: Path) -> None:
    found = results(tmp_path / "x", a={"Z.set_mm": [1.0]}, b={"X.set_mm": [5.0]})
    table = query(found, "select * from signals order by run")
    assert list(table.columns) == ["run", "time_ns", "Z.set_mm", "X.set_mm"]
    assert table["Z.set_mm"].isna().tolist() == [False, True]
    assert table["X.set_mm"].isna().tolist() == [True, False]


def test_all_three_tables_are_joined_by_the_run(tmp_path: Path) -> None:
    found = results(tmp_path / "x", a={"Z.set_mm": [1.0, 2.0]}, b={"Z.set_mm": [5.0]})
    sql = "select run, verdict, metric, count(*) as n from signals join cases using (run)"
    table = query(found, f"{sql} join checks using (run) group by all order by run")
    assert table.to_dict("list") == {
        "run": ["a", "b"], "verdict": ["pass", "pass"], "metric": ["m", "m"], "n": [2, 1],
    }  # fmt: skip


def test_without_a_series_there_are_no_signals_to_ask(tmp_path: Path) -> None:
    found = results(tmp_path / "x")
    assert query(found, "select count(*) as n from cases")["n"].tolist() == [0]
    with pytest.raises(UserError, match="the query was refused") as caught:
        query(found, "select * from signals")
    assert caught.value.hint.startswith("tables: cases, checks, signals")  # type: ignore[union-attr]


@pytest.mark.parametrize("which", ["a", "b"])
def test_a_damaged_time_series_is_named_and_not_the_query(tmp_path: Path, which: str) -> None:
    """Whichever it is of several."""
    found = results(tmp_path / "x", a={"Z.set_mm": [1.0]}, b={"Z.set_mm": [5.0]})
    path = found.traces()[which]
    path.write_bytes(b"PAR1 no series")
    with pytest.raises(UserError) as caught:
        query(found, "select * from signals")
    assert caught.value.file == str(path)
    assert "the query was refused" not in caught.value.message


def test_a_wrong_query_over_sound_series_is_refused_by_its_first_line(tmp_path: Path) -> None:
    found = results(tmp_path / "x", a={"Z.set_mm": [1.0]})
    with pytest.raises(UserError, match="the query was refused") as caught:
        query(found, "select nothing_of_this from cases")
    assert "\n" not in caught.value.message
    assert caught.value.hint == (
        "tables: cases, checks, signals; `describe cases` lists the columns of one"
    )
