"""Tables of a results folder that no machine has made: each cell from facts written by hand."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import Step, alarm, block_trace, facts, kept

from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.bus import BusFigures
from axisrig.bench.record.distance import ChannelDistanceRecord, Diagnosis
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.facts import Facts, run_text
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS
from axisrig.results.loading import _segment, load

STEPS = (
    Step("N10 G1 Z5", "feed", 1, 2, 6, feed_mm_min=600, path_mm=5, travelled_mm=4),
    Step("N20 of a later version", "unheard of", 6, 9, 10, "stopped", file="sub.nc", line=7),
    Step("", "feed", 10, 10, 12),
)


def left() -> Facts:
    diagnosis = (Diagnosis(2 * MS, {"zstd": "ACTIVE"}), Diagnosis(4 * MS, {"zstd": "ERROR"}))
    return facts(
        axes={
            "Z": AxisRecord("can1", 1, 1000.0, states=(DriveState(3 * MS, "FAULT", True),
                                                       DriveState(1 * MS, "READY"))),
        },
        blocks=block_trace(STEPS, holds=((3 * MS, 5 * MS), (9 * MS, 20 * MS))),
        alarms=(alarm(50052, 2 * MS, axis="Z"),),
        distance_3d=ChannelDistanceRecord(diagnosis=diagnosis),
        channel={"configuration.decoder.a": 1, "other": 2, "dist_ctrl[0].kp": 3},
        edges=(
            EdgeTruth("probe", "Z", True, 1 * MS, 5.0, 4.5, 1 * MS + 400, 5.1, 4.6),
            EdgeTruth("cam", "C", False, 2 * MS, -31.0, -30.0, 9 * MS, None, None, -30.5),
        ),
        buses=tuple(BusFigures(name, 1_000_000, 0, 0, 0, 0, 0, "", (), ()) for name in ("a", "b")),
    )  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("results")
    (folder / "cases.csv").write_text(
        "run,verdict,plc:V.E.A,plc:V.E.B,plant:p.x_mm,runs\n"
        "r1,pass,1,1,2.5,\nr2,fail,2,fast,,\np-c,pass,,,,2\n",
        encoding="utf-8",
    )
    (folder / "results.csv").write_text(
        "run,check,metric,value,verdict\nr1,<= 1,m,0.5,pass\n", encoding="utf-8"
    )
    for name in ("runs", "traces"):
        (folder / name).mkdir()
    (folder / "runs" / "r1.json").write_text(run_text(left()), encoding="utf-8")
    (folder / "runs" / "r2.json").write_text(run_text(None, "it broke"), encoding="utf-8")
    table = pa.table({"time_ns": np.arange(3, dtype=np.int64) * MS, "Z.set_mm": [0.0, 1.0, 2.0]})
    kept(table, folder / "traces" / "r1.parquet")
    return folder


def test_inputs_are_numbers_where_all_cells_are(made: Path) -> None:
    cases = load(made).cases
    assert cases["plc:V.E.A"].dtype == float
    assert cases["plc:V.E.A"].tolist()[:2] == [1.0, 2.0]
    assert cases["plc:V.E.B"].tolist() == ["1", "fast", ""]
    assert cases.attrs["units"] == {"sim_s": "s", "wall_s": "s", "plant:p.x_mm": "mm"}
    checks = load(made).checks
    places = list(checks.columns)
    assert places.index("text") == places.index("value") + 1


def test_events_are_by_time_with_the_states_of_drives(made: Path) -> None:
    events = load(made).events("r1")
    found = [tuple(row) for row in events.itertuples(index=False)]
    assert [row[0] // MS for row in found] == [1, 2, 3, *(row[0] // MS for row in found[3:])]
    assert found[0] == (1 * MS, "state", "Z", "READY")
    assert found[1][1:3] == ("alarm", "")
    assert found[1][3].startswith("ID 50052")
    assert found[2] == (3 * MS, "state", "Z", "FAULT")
    assert events.attrs["units"] == {"time_ns": "ns"}
    assert load(made).events("r2").empty  # it has left no facts


def test_edges_have_their_places_and_units(made: Path) -> None:
    """A latch that the run did not reach, or an axis without a second encoder, has no number."""
    table = load(made).edges("r1")
    assert list(table["axis"]) == ["Z", "C"]
    assert list(table["level"]) == [True, False]
    assert list(table["edge_ns"]) == [1 * MS, 2 * MS]
    assert list(table["load_mm"]) == [4.5, -30.0]
    assert list(np.isnan(table["latch_motor_mm"])) == [False, True]
    assert list(np.isnan(table["second_mm"])) == [True, False]
    assert str(table["latch_ns"].dtype) == "int64"
    lengths = ("motor_mm", "load_mm", "second_mm")
    assert table.attrs["units"] == {
        **dict.fromkeys(("edge_ns", "latch_ns", "latch_jitter_ns"), "ns"),
        **dict.fromkeys((*lengths, *(f"latch_{name}" for name in lengths)), "mm"),
    }
    with pytest.raises(UserError, match="no places of edges"):
        load(made).edges("r2")


def test_a_run_without_an_edge_has_a_table_without_rows(made: Path, tmp_path: Path) -> None:
    """It is no recording of an older version, which has no table at all."""
    folder = shutil.copytree(made, tmp_path / "out")
    text = run_text(replace(left(), edges=()))
    (folder / "runs" / "r1.json").write_text(text, encoding="utf-8")
    table = load(folder).edges("r1")
    assert (len(table), list(table.columns)) == (0, list(load(made).edges("r1").columns))
    assert str(table["latch_ns"].dtype) == "int64"


def test_blocks_have_their_waits_and_holds(made: Path) -> None:
    blocks = load(made).blocks("r1")
    assert blocks["waited_ns"].tolist() == [1 * MS, 3 * MS, 0]
    assert blocks["held_ns"].tolist() == [2 * MS, 1 * MS, 2 * MS]
    assert blocks["group"].tolist() == ["motion", "other", "motion"]
    assert blocks["state"].tolist() == ["done", "stopped", "done"]
    assert blocks["number"].tolist()[:2] == [10, 20]
    assert blocks["number"].isna().tolist() == [False, False, True]
    assert blocks[["file", "line"]].to_numpy().tolist() == [
        ["probe.nc", 1], ["sub.nc", 7], ["probe.nc", 1],
    ]  # fmt: skip
    assert (blocks["feed_mm_min"][0], blocks["path_mm"][0], blocks["travelled_mm"][0]) == (
        600,
        5,
        4,
    )
    assert blocks.attrs["units"]["waited_ns"] == "ns"
    assert blocks.attrs["units"]["feed_mm_min"] == "mm/min"


def test_diagnosis_has_a_row_for_each_dump(made: Path) -> None:
    table = load(made).diagnosis("r1")
    assert table.to_numpy().tolist() == [[2 * MS, "ACTIVE"], [4 * MS, "ERROR"]]
    assert table.attrs["units"] == {"time_ns": "ns"}
    assert table.attrs["decoder"] == {"configuration.decoder.a": 1}


@pytest.mark.parametrize(
    ("what", "run", "words"),
    [
        ("signals", "r2", "the run left no time series"),
        ("blocks", "r2", "the run left no block trace"),
        ("diagnosis", "r2", "the run has no 3D distance control"),
        ("events", "p-c", "this row is about several runs"),
        ("signals", "p-c", "this row is about several runs"),
        ("frames", "far away", "the folder has no such run"),
    ],
)
def test_what_a_run_does_not_have_is_refused_with_its_name(
    made: Path, what: str, run: str, words: str
) -> None:
    with pytest.raises(UserError) as caught:
        getattr(load(made), what)(run)
    assert (caught.value.message, caught.value.file, caught.value.value) == (words, str(made), run)
    if run == "far away":
        assert caught.value.allowed == "r1, r2, p-c"


def test_a_run_without_3d_control_has_no_diagnosis(made: Path, tmp_path: Path) -> None:
    shutil.copytree(made, tmp_path / "other")
    (tmp_path / "other" / "runs" / "r1.json").write_text(run_text(facts()), encoding="utf-8")
    with pytest.raises(UserError, match="the run has no 3D distance control"):
        load(tmp_path / "other").diagnosis("r1")


@pytest.mark.parametrize(
    ("channel", "segments", "name"),
    [(0, "ab", "a"), (1, "ab", "b"), (2, "ab", "2"), (-1, "ab", "-1"), ("can7", "ab", "can7"),
     (None, "a", "a"), (None, "ab", ""), (None, "", "")],
)  # fmt: skip
def test_a_frame_is_of_the_segment_that_its_log_counts(
    channel: int | str | None, segments: str, name: str
) -> None:
    assert _segment(channel, list(segments)) == name
