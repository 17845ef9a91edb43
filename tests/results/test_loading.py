"""Results as tables of pandas, MF4, CSV and SQL: against the files as other tools read them."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import can
import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from axisrig.kernel.errors import UserError
from axisrig.results import Results, load
from axisrig.results.query import query

ROOT = Path(__file__).parents[2]
NOTEBOOK = ROOT / "docs" / "results.ipynb"


@pytest.fixture(scope="module")
def results(folder_of_results: Path) -> Results:
    return load(folder_of_results)


def test_cases_are_typed_and_have_units(results: Results) -> None:
    cases = results.cases
    assert list(cases["run"]) == ["touch-slow", "touch-fast"]
    assert list(cases.loc[cases["verdict"] >= "fail", "run"]) == ["touch-fast"]
    assert cases["plc:V.E.FEED"].tolist() == [600, 3000]
    assert np.isnan(cases["plant:probe.pretravel_um"][0])
    assert cases.attrs["units"] == {"sim_s": "s", "wall_s": "s", "plant:probe.pretravel_um": "um"}
    assert cases["seed"].dtype == "Int64"


def test_checks_hold_the_numbers_of_the_table(results: Results, folder_of_results: Path) -> None:
    plain = pd.read_csv(folder_of_results / "results.csv")
    checks = results.checks
    assert list(checks["metric"]) == list(plain["metric"])
    numbers = pd.to_numeric(plain["value"], errors="coerce")
    np.testing.assert_array_equal(checks["value"], numbers)
    # The closed form: pre-travel and 4 us of input delay at 50 mm/s, one increment of 0.0095 um
    row = checks[(checks["run"] == "touch-fast") & (checks["metric"] == "latch_error_um")].iloc[0]
    assert row["value"] == pytest.approx(-(5.0 + 0.2), abs=0.0096)
    assert (row["unit"], row["lower"]) == ("um", -1.0)


def test_signals_are_those_of_the_file(results: Results, folder_of_results: Path) -> None:
    signals = results.signals("touch-slow")
    plain = pq.read_table(folder_of_results / "traces" / "touch-slow.parquet").to_pandas()
    assert set(signals.columns) <= set(plain.columns)
    for column in signals:
        np.testing.assert_array_equal(signals[column], plain[column])
    assert signals.attrs["units"]["Z.velocity_mm_s"] == "mm/s"
    assert (signals.attrs["run"], signals.attrs["rig"]) == ("touch-slow", "rigs/probe-z.toml")


def test_events_are_those_of_the_run_file(results: Results, folder_of_results: Path) -> None:
    events = results.events("touch-slow")
    facts = json.loads(
        (folder_of_results / "runs" / "touch-slow.json").read_text(encoding="utf-8")
    )["facts"]
    assert events["time_ns"].is_monotonic_increasing
    contacts = [contact["time_ns"] for contact in facts["probes"]["probe"]["contacts"]]
    assert events.loc[events["kind"] == "contact", "time_ns"].tolist() == contacts
    states = facts["axes"]["Z"]["states"]
    assert events.loc[events["kind"] == "state", "text"].tolist() == [s["state"] for s in states]


@pytest.mark.long
def test_blocks_are_those_of_the_program(results: Results, folder_of_results: Path) -> None:
    """Against the text of the program, the set positions of the trace and the measurement run."""
    blocks, signals = results.blocks("touch-slow"), results.signals("touch-slow")
    program = folder_of_results.parent / "programs" / "probe-z.nc"
    lines = program.read_text(encoding="utf-8").splitlines()
    for _, row in blocks.iterrows():
        assert lines[row["line"] - 1].startswith(row["text"])
        assert row["text"].startswith(f"N{row['number']}")
        assert Path(row["file"]).name == "probe-z.nc"
    assert (blocks["due_ns"] <= blocks["begin_ns"]).all()
    assert (blocks["begin_ns"] <= blocks["end_ns"]).all()
    assert blocks["begin_ns"].is_monotonic_increasing
    (run,) = json.loads(
        (folder_of_results / "runs" / "touch-slow.json").read_text(encoding="utf-8")
    )["facts"]["runs"]
    (row,) = [row for _, row in blocks.iterrows() if row["kind"] == "measurement run"]
    assert (row["begin_ns"], row["end_ns"]) == (run["begin_ns"], run["end_ns"])
    assert (row["state"], row["group"], row["feed_mm_min"]) == ("signal", "measuring", 600)
    # The set position moves within blocks that move, and nowhere else
    moved = signals["time_ns"][signals["Z.set_mm"].diff().abs() > 1e-9]
    moving = blocks[blocks["group"].isin(["motion", "measuring"])]
    period_ns = 1_000_000
    for at in moved:
        assert ((moving["begin_ns"] - period_ns <= at) & (at <= moving["end_ns"])).any()
    assert blocks.attrs["units"]["begin_ns"] == "ns"


def test_an_older_recording_has_no_block_trace(folder_of_results: Path, tmp_path: Path) -> None:
    shutil.copytree(folder_of_results, tmp_path / "old")
    path = tmp_path / "old" / "runs" / "touch-slow.json"
    content = json.loads(path.read_text(encoding="utf-8")) | {"version": 1}
    del content["facts"]["blocks"]
    path.write_text(json.dumps(content), encoding="utf-8")
    older = load(tmp_path / "old")
    assert not older.events("touch-slow").empty
    with pytest.raises(UserError, match="the run left no block trace"):
        older.blocks("touch-slow")


@pytest.mark.long
def test_frames_are_those_of_python_can(results: Results, folder_of_results: Path) -> None:
    frames = results.frames("touch-slow")
    plain = list(can.LogReader(folder_of_results / "bus" / "touch-slow.blf"))
    assert len(frames) == len(plain)
    assert frames["id"].tolist() == [message.arbitration_id for message in plain]
    assert frames["data"].tolist() == [bytes(message.data).hex() for message in plain]
    assert set(frames["segment"]) == {"can1"}


def test_an_unknown_run_is_named_with_the_nearest(results: Results) -> None:
    with pytest.raises(UserError, match="the folder has no such run") as caught:
        results.signals("touch-slwo")
    assert "touch-slow" in str(caught.value.allowed)


@pytest.mark.parametrize(
    ("run", "allowed"), [("alpah", "alpha"), ("GAMMA-2", "gamma"), ("zzz", "alpha, beta, gamma")]
)
def test_of_an_unknown_run_those_that_look_alike_are_named_else_all(
    tmp_path: Path, run: str, allowed: str
) -> None:
    (tmp_path / "cases.csv").write_text("run,verdict\nalpha,pass\nbeta,pass\ngamma,pass\n")
    (tmp_path / "results.csv").write_text("run,metric,verdict,value\n")
    results = load(tmp_path)
    for table in (results.signals, results.blocks):
        with pytest.raises(UserError, match="the folder has no such run") as caught:
            table(run)
        given = caught.value.allowed or ()
        assert (given if isinstance(given, str) else ", ".join(given)) == allowed
        assert caught.value.value == run


def test_tables_of_another_tool_load(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("run,verdict\na,pass\nb,fail\n", encoding="utf-8")
    (tmp_path / "results.csv").write_text(
        "run,metric,verdict,value\na,x,pass,1.5\nb,x,fail,text\n", encoding="utf-8"
    )
    results = load(str(tmp_path))
    assert results.cases["verdict"].tolist() == ["pass", "fail"]
    assert results.checks["value"].tolist() == pytest.approx([1.5, np.nan], nan_ok=True)
    assert results.checks["text"].tolist() == ["1.5", "text"]
    with pytest.raises(UserError, match="left no time series"):
        results.signals("a")


def test_mf4_is_what_asammdf_reads_back(
    folder_of_results: Path, tmp_path: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    asammdf = pytest.importorskip("asammdf", reason="the extra `mdf` is not installed")
    code, out, _ = axisrig("export", folder_of_results, "touch-slow", "--mf4", "-o", tmp_path)
    assert (code, out.split()) == (0, [str(tmp_path / "touch-slow.mf4")])
    plain = pq.read_table(folder_of_results / "traces" / "touch-slow.parquet").to_pandas()
    with asammdf.MDF(tmp_path / "touch-slow.mf4") as mdf:
        signal = mdf.get("Z.truth_mm")
        assert signal.unit == "mm"
        np.testing.assert_array_equal(signal.samples, plain["Z.truth_mm"])
        np.testing.assert_allclose(signal.timestamps, plain["time_ns"] / 1e9, rtol=1e-15)


@pytest.mark.long
def test_csv_has_its_units_in_the_second_row(
    folder_of_results: Path, tmp_path: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    code, out, _ = axisrig("export", folder_of_results, "--csv", "-o", tmp_path)
    assert (code, len(out.split())) == (0, 2)
    read = pd.read_csv(tmp_path / "touch-fast.csv", header=[0, 1])
    plain = pq.read_table(folder_of_results / "traces" / "touch-fast.parquet").to_pandas()
    np.testing.assert_array_equal(read["Z.truth_mm", "mm"], plain["Z.truth_mm"])
    assert axisrig("export", folder_of_results)[0] == 2


@pytest.mark.long
def test_sql_asks_all_tables(
    folder_of_results: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    pytest.importorskip("duckdb", reason="the extra `query` is not installed")
    sql = (
        'select c.run, max(abs("Z.cnc_lag_mm")) as lag_mm from signals s join cases c'
        " on s.run = c.run where c.verdict = 'fail' group by c.run"
    )
    code, out, _ = axisrig("query", folder_of_results, sql, "--csv")
    plain = pq.read_table(folder_of_results / "traces" / "touch-fast.parquet").to_pandas()
    assert (code, out.splitlines()[0]) == (0, "run,lag_mm")
    run, lag_mm = out.splitlines()[1].split(",")
    assert (run, float(lag_mm)) == ("touch-fast", plain["Z.cnc_lag_mm"].abs().max())
    code, _, err = axisrig("query", folder_of_results, "selec 1")
    assert code == 2
    assert err.startswith("error: the query was refused: ")
    assert err.count("\n") == 1


OUTSIDE = [
    "create table t as pivot cases on verdict using count(*)",
    "with c as (pivot cases on verdict using count(*)) insert into cases select * from c",
    "select * from read_csv('{place}/secret.csv')", "load httpfs", "select 1;select 1", "",
    "copy (select 1) to '{trace}' (use_tmp_file false)", "select * from results",
    "set enable_external_access = true", "explain analyze copy (select 1) to '{place}/new.csv'",
    "select * from 'secret.csv'", "select * from read_text('secret.csv')",
    "select * from glob('*')", "install httpfs", "attach '{place}/new.db'",
    "copy (select 1) to '{place}/new.csv'", "export database '{place}/new'",
    "select 1; select 2", "create table t as select 1", " ; ", "-- nothing", "select * from sql",
]  # fmt: skip


@pytest.mark.long(but=9)
@pytest.mark.parametrize("sql", OUTSIDE)
def test_a_query_reads_the_folder_and_nothing_else(
    folder_of_results: Path, monkeypatch: pytest.MonkeyPatch, sql: str
) -> None:
    """No other file, no extension, one statement: the text may come from anybody."""
    pytest.importorskip("duckdb", reason="the extra `query` is not installed")
    place = folder_of_results.parent
    (place / "secret.csv").write_text("a\n1\n", encoding="utf-8")
    monkeypatch.chdir(place)
    results = load(folder_of_results)
    trace = next(iter(results.traces().values()))
    before = {path: path.stat() for path in place.rglob("*")}
    with pytest.raises(UserError, match=r"the query was refused|is one statement that selects"):
        query(results, sql.format(place=place, trace=trace))
    after = {path: path.stat() for path in place.rglob("*")}
    assert {p: s.st_mtime_ns for p, s in before.items()} == {
        p: s.st_mtime_ns for p, s in after.items()
    }


@pytest.mark.parametrize(
    ("sql", "rows"),
    [
        ("from cases", 2), ("describe checks", 14), ("with c as (from cases) select * from c;", 2),
        ("pivot cases on verdict using count(*) group by plan", 1), ("select 1 -- ;", 1),
        ("Pivot_Wider cases on verdict using count(*) group by plan; -- done", 1),
        ("with c as (pivot cases on verdict using count(*) group by plan) select * from c", 1),
        ("-- as columns\n(pivot cases on verdict using count(*) group by plan)", 1),
    ],
)  # fmt: skip
def test_a_query_in_any_form_of_a_selection(folder_of_results: Path, sql: str, rows: int) -> None:
    pytest.importorskip("duckdb", reason="the extra `query` is not installed")
    assert len(query(load(folder_of_results), sql)) == rows


@pytest.mark.long
def test_a_query_of_a_damaged_series_names_it(folder_of_results: Path, tmp_path: Path) -> None:
    pytest.importorskip("duckdb", reason="the extra `query` is not installed")
    folder = shutil.copytree(folder_of_results, tmp_path / "out")
    path = folder / "traces" / "touch-fast.parquet"
    path.write_bytes(path.read_bytes()[:-100])
    for sql in ("select count(*) from signals", "select * from nothing"):
        with pytest.raises(UserError) as caught:
            query(load(folder), sql)
        assert caught.value.file == str(path.absolute())


@pytest.mark.long
def test_a_query_of_a_folder_without_rows(folder_of_results: Path, tmp_path: Path) -> None:
    pytest.importorskip("duckdb", reason="the extra `query` is not installed")
    for name in ("cases.csv", "results.csv", "manifest.json"):
        head = (folder_of_results / name).read_text(encoding="utf-8")
        text = head if name.endswith("json") else head.splitlines(keepends=True)[0]
        (tmp_path / name).write_text(text, encoding="utf-8")
    results = load(tmp_path)
    assert len(query(results, "select run, verdict from cases")) == 0
    assert len(query(results, "select metric, value from checks")) == 0
    with pytest.raises(UserError, match="signals does not exist"):
        query(results, "from signals")


class _Nothing:
    """Finds none of the extras, as where they are not installed."""

    def find_spec(self, name: str, *_: object) -> None:
        if name in ("asammdf", "duckdb"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def test_without_the_extra_the_message_says_how_to_get_it(
    folder_of_results: Path,
    axisrig: Callable[..., tuple[int, str, str]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in ("asammdf", "duckdb"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "meta_path", [_Nothing(), *sys.meta_path])
    for words in (("export", folder_of_results, "--mf4"), ("query", folder_of_results, "select 1")):
        code, _, err = axisrig(*words)
        assert code == 2
        assert "pip install 'axisrig[" in err


@pytest.mark.long
def test_the_notebook_runs(folder_of_results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    shutil.copytree(
        folder_of_results, folder_of_results.parent / "out2" / "touch", dirs_exist_ok=True
    )
    monkeypatch.chdir(folder_of_results.parent / "out2" / "touch")
    names: dict[str, object] = {}
    for cell in code:
        exec(cell, names)
    assert isinstance(names["results"], Results)


@pytest.mark.long
def test_ten_thousand_runs_are_read_at_once(tmp_path: Path) -> None:
    """What is read, not how fast: `axisrig.results` measures nothing (docs/performance.md)."""
    count = 10_000
    rows = "".join(f"r{n},pass,{n}\n" for n in range(count))
    (tmp_path / "cases.csv").write_text(f"run,verdict,plc:V.E.N\n{rows}", encoding="utf-8")
    rows = "".join(f"r{n},x,pass,{n}\n" for n in range(count))
    (tmp_path / "results.csv").write_text(f"run,metric,verdict,value\n{rows}", encoding="utf-8")
    results = load(tmp_path)
    assert results.cases["plc:V.E.N"].sum() == results.checks["value"].sum() == 49_995_000


@pytest.mark.long
def test_the_command_line_starts_without_pandas() -> None:
    code = "import sys, axisrig.bench.cli.main; print([n for n in sys.modules if n == 'pandas'])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_only_inputs_become_numbers(tmp_path: Path) -> None:
    """A serial number, a requirement and a note may have digits alone: a 0 in front stays."""
    words = {"info:serial": "007", "note:day": "0101", "requirement": "0042", "tags": "1"}
    cells = {"verdict": "pass", "plc:V.E.A": "007", **words}
    lines = [["run", *cells], *([name, *cells.values()] for name in ("a", "b"))]
    table = "".join(",".join(line) + "\n" for line in lines)
    (tmp_path / "cases.csv").write_text(table, encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    cases_of = load(tmp_path).cases
    for name, text in words.items():
        assert cases_of[name].tolist() == [text, text], name
    assert cases_of["plc:V.E.A"].tolist() == [7.0, 7.0]


def test_a_folder_whose_tables_have_no_row_has_their_columns(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("run,verdict\n", encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    found = load(tmp_path)
    assert {"run", "verdict", "plan", "case", "seed"} <= set(found.cases.columns)
    assert {"run", "metric", "value", "text", "unit", "verdict"} <= set(found.checks.columns)
    assert (len(found.cases), len(found.checks)) == (0, 0)
