"""Results and bus logs that somebody has edited or made: one line and code 2, never a traceback."""

import contextlib
import csv
import io
import json
import random
import shutil
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import can
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from cli_plan import HEADER

from axisrig.bench.cli.main import main
from axisrig.bench.tools.bus_log.choice.channels import Channels

Call = Callable[..., tuple[int, str, str]]

RUN = "plan-a"
LOGS = ("blf", "candump", "asc", "pcap")
SUFFIXES = {"blf": ".blf", "candump": ".log", "asc": ".asc", "pcap": ".pcap"}
ODD: list[Any] = [
    None, True, -1, 0, 1e308, float("nan"), float("-inf"), 10**40, 1.5, "", "x", "9" * 50,
    [], {}, [1], {"a": 1}, [[]], [{}],
]  # fmt: skip
ODD_CELLS = [
    "", "-1", "nan", "inf", "1e999", "x", "../../etc/passwd", "pass", "a\nb", '"', "0", "9" * 400,
    "error", "\x00", "1 2 3",
]  # fmt: skip


@pytest.fixture(scope="session")
def results(originals: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of one run with every kind of log, made once."""
    from axisrig.bench.campaign.campaign import Choice, run_campaign  # noqa: PLC0415
    from axisrig.bench.campaign.runner import no_stopwatch  # noqa: PLC0415

    place = tmp_path_factory.mktemp("foreign")
    shutil.copytree(originals, place, dirs_exist_ok=True)
    row = "a,part.nc,rig.toml,3000,== 1,"
    (place / "plan.csv").write_text(f"{HEADER}\n{row}\n", encoding="utf-8")
    run_campaign(
        [place / "plan.csv"], out=place / "out", select=Choice(), jobs=1, timeout_s=None,
        assignments=[], command=["axisrig"], started="", stopwatch=no_stopwatch, bus_logs=LOGS,
    )  # fmt: skip
    return place / "out"


def _call(*words: str | Path) -> tuple[object, str]:
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as ended,
    ):
        main([str(word) for word in words])
    return ended.value.code, err.getvalue()


def _places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths to everything inside a JSON value, of long lists to the first ones."""
    items = value.items() if isinstance(value, dict) else enumerate(value[:5])
    for key, inner in items:
        yield (*path, key)
        if isinstance(inner, dict | list):
            yield from _places(inner, (*path, key))


def _edit_json(text: str, chance: random.Random) -> str:
    content = json.loads(text)
    path = chance.choice(list(_places(content)))
    inside = content
    for key in path[:-1]:
        inside = inside[key]
    if chance.random() < 0.25:
        del inside[path[-1]]
    else:
        inside[path[-1]] = chance.choice(ODD)
    return json.dumps(content)


def _edit_table(text: str, chance: random.Random) -> str:
    table = list(csv.reader(io.StringIO(text)))
    row = chance.choice(table)
    row[chance.randrange(len(row))] = chance.choice(ODD_CELLS)
    out = io.StringIO()
    csv.writer(out).writerows(table)
    return out.getvalue()


def _edit_bytes(data: bytes, chance: random.Random) -> bytes:
    edited = bytearray(data)
    for _ in range(chance.choice([1, 1, 2, 5])):
        at = chance.randrange(len(edited) or 1)
        new = bytes(chance.randrange(256) for _ in range(chance.choice([0, 1, 4])))
        edited[at : at + chance.choice([0, 1, 8])] = chance.choice([new, b"\xff" * 4, b"\0" * 8])
        if chance.random() < 0.1:
            del edited[at:]
    return bytes(edited)


def _edit_trace(path: Path, chance: random.Random) -> None:
    table = pq.read_table(path)
    at, rows = chance.randrange(table.num_columns), table.num_rows
    columns = [["x"] * rows, [None] * rows, [1e308] * rows, [[1]] * rows, [float("nan")] * rows]
    changed = chance.choice([None, *columns])
    name = table.column_names[at]
    table = table.remove_column(at)
    if changed is not None:
        table = table.append_column(name, pa.array(changed))
    if chance.random() < 0.2:
        table = table.append_column(
            chance.choice([name, table.column_names[0]]), pa.array(columns[2])
        )
    pq.write_table(table, path)


def _edit(folder: Path, kind: str, chance: random.Random) -> list[list[str | Path]]:
    """Edit a file of one kind and return the commands that read it."""
    report: list[str | Path] = ["report", folder]
    if kind in SUFFIXES:
        path = folder / "bus" / f"{RUN}{SUFFIXES[kind]}"
        path.write_bytes(_edit_bytes(path.read_bytes(), chance))
        return [["bus", path, "--all"], ["bus", path, "--rig", folder.parent / "rig.toml"]]
    if kind == "trace":
        path = folder / "traces" / f"{RUN}.parquet"
        if chance.random() < 0.5:
            path.write_bytes(_edit_bytes(path.read_bytes(), chance))
        else:
            _edit_trace(path, chance)
        return [report]
    bus: list[str | Path] = ["bus", folder, RUN, "--to", "20"]
    replay: list[str | Path] = ["replay", folder, RUN]
    files = {"run": f"runs/{RUN}.json", "manifest": "manifest.json"}
    path = folder / files.get(kind, f"{kind}.csv")
    text = path.read_text(encoding="utf-8")
    if chance.random() < 0.2:
        path.write_bytes(_edit_bytes(text.encode(), chance))
    else:
        edit = _edit_json if kind in files else _edit_table
        path.write_text(edit(text, chance), encoding="utf-8", newline="")
    return [report] if kind == "run" else [report, bus, *([replay] if kind == "cases" else [])]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("count", [3, pytest.param(25, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", ["cases", "results", "run", "manifest", "trace", *SUFFIXES])
def test_edited_files_give_a_line_or_their_report(
    results: Path, tmp_path: Path, kind: str, count: int
) -> None:
    for number in range(count):
        chance = random.Random(f"{kind} {number}")
        shutil.copytree(results.parent, tmp_path / "place", dirs_exist_ok=True)
        for words in _edit(tmp_path / "place" / "out", kind, chance):
            code, err = _call(*words)
            assert code in ((0, 1, 2, 3, 4) if words[0] == "replay" else (0, 2))
            if code == 2:
                assert err.startswith("error: ")
                assert err.count("\n") == 1, (number, err)
                assert len(err) < 1000


CELLS = [
    ("cases.csv", "sim_s", "soon", "sim_s 'soon' is no time"),
    ("cases.csv", "wall_s", "-1", "wall_s '-1' is no time"),
    ("cases.csv", "run", "../../etc/passwd", "is no run id"),
    ("cases.csv", "verdict", "PASS", "verdict 'PASS' is no verdict"),
    ("results.csv", "verdict", "", "verdict '' is no verdict"),
    ("results.csv", "uncertainty", "nan", "uncertainty 'nan' is no uncertainty"),
]


@pytest.mark.parametrize(("name", "column", "cell", "text"), CELLS)
def test_a_cell_that_is_no_result_is_told_with_its_line(
    results: Path, tmp_path: Path, name: str, column: str, cell: str, text: str
) -> None:
    folder = shutil.copytree(results, tmp_path / "out")
    table = list(csv.reader((folder / name).read_text(encoding="utf-8").splitlines()))
    table[1][table[0].index(column)] = cell
    with (folder / name).open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(table)
    code, err = _call("report", folder)
    assert code == 2
    assert f"{name}:2: the results folder is damaged: " in err
    assert text in err


def test_a_run_that_is_there_twice_is_damaged(results: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(results, tmp_path / "out")
    lines = (folder / "cases.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "cases.csv").write_text("".join([*lines, lines[-1]]), encoding="utf-8")
    code, err = _call("report", folder)
    assert code == 2
    assert "cases.csv:3: the results folder is damaged: the run plan-a is there twice" in err


@pytest.mark.long
def test_a_table_that_a_spreadsheet_has_saved_is_read(results: Path, tmp_path: Path) -> None:
    """A byte order mark and line ends of Windows."""
    folder = shutil.copytree(results, tmp_path / "out")
    for name in ("cases.csv", "results.csv"):
        text = (folder / name).read_text(encoding="utf-8").replace("\n", "\r\n")
        (folder / name).write_bytes(text.encode("utf-8-sig"))
    assert _call("report", folder) == (0, "")


# ---- foreign logs


@pytest.mark.parametrize("number", [-1, -2, 1, 7, -40000])
def test_a_channel_outside_the_rig_names_no_segment_of_it(number: int) -> None:
    channels = Channels(["can1"], {}, lambda: {0, number})
    assert channels.segment(0) == "can1"
    assert channels.segment(number) == str(number)


def test_a_frame_of_channel_0_of_a_blf_is_not_put_on_the_last_segment(
    results: Path, place: Path, axisrig: Call
) -> None:
    """Other tools write 0 for any channel, which counts as -1 here."""
    path = place / "foreign.blf"
    frame = can.Message(arbitration_id=0x183, is_extended_id=False, data=b"12345678", channel=-1)
    with can.BLFWriter(path) as writer:
        writer.on_message_received(frame)
    code, out, _ = axisrig("bus", path, "--rig", "rig.toml")
    note, line = out.splitlines()
    assert (code, line.split()[1:3]) == (0, ["-1", "183"])
    assert "channel -1 of the log is no segment of the rig (can1)" in note
    assert "Z.TPDO1" not in out


def test_objects_of_a_blf_that_cannot_be_read_are_not_left_out_silently(
    results: Path, place: Path, axisrig: Call
) -> None:
    """The version of an object's header stands 6 bytes behind its mark."""
    path = place / "odd.blf"
    with can.BLFWriter(path, compression_level=0) as writer:
        for _ in range(3):
            writer.on_message_received(can.Message(arbitration_id=0x80, is_extended_id=False))
    data = bytearray(path.read_bytes())
    struct.pack_into("<H", data, data.rindex(b"LOBJ") + 6, 77)
    path.write_bytes(data)
    code, _, err = axisrig("bus", path)
    assert (code, err.count("\n")) == (2, 1)
    assert "Unknown object header version (77)" in err
