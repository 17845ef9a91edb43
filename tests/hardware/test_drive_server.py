"""The drives of a rig on a bus of python-can in this process: what a master outside finds."""

import csv
import json
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import can
import pyarrow.parquet as pq
import pytest

from axisrig.bench.bus.paced import RealTime
from axisrig.bench.campaign.hardware_runs import Outside
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.tools.virtual_drive.serve import (
    DriveServer,
    drive_settings,
    only_axes,
    whose_eds,
    write_eds,
)
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
REAL = Hardware(RealTime(time.monotonic_ns, time.sleep))


def outside(**words: Any) -> Outside:
    return Outside(lambda: nullcontext(REAL), True, lambda _: None, **words)


@pytest.mark.long
def test_a_master_starts_the_drive_and_every_sync_is_in_the_trace(tmp_path: Path) -> None:
    """NMT and three SYNCs that were sent before the drives begin to run; node 3 answers."""
    on_bus = outside(interface="virtual", channel="drive-server")
    settings = drive_settings(RIGS / "probe-z.toml", on_bus, [], [])
    lines: list[str] = []
    with (
        can.Bus("drive-server", interface="virtual") as master,
        DriveServer(settings, REAL, lines.append, folder=tmp_path) as server,
    ):
        for can_id, data in ((0x000, [1, 3]), (0x080, []), (0x080, []), (0x080, [])):
            master.send(can.Message(arbitration_id=can_id, data=data, is_extended_id=False))
        server.run(60 * MS)
        heard = {message.arbitration_id for message in iter(lambda: master.recv(0.0), None)}
        assert not any(segment.keeps_load for segment in server.segments.values())
    assert 0x703 in heard  # its boot-up
    words = [" ".join(line.split()) for line in lines]
    assert words[0].startswith("segment can1: ")
    assert words[1] == "axis Z: drive with node 3"
    assert any(line.endswith("Z NMT start, node 3") for line in words)
    assert sum("SYNC begins on can1" in line for line in words) == 1
    trace = pq.read_table(tmp_path / "trace.parquet")
    assert trace.num_rows == 3
    assert {"time_ns", "Z.truth_mm", "Z.demand_mm"} <= set(trace.column_names)
    assert (tmp_path / "bus.blf").stat().st_size > 0
    with (tmp_path / "events.csv").open(encoding="utf-8") as file:
        assert "NMT" in {row["kind"] for row in csv.DictReader(file)}


SAVE_ALL = bytes.fromhex("23101001") + b"save"


def life(channel: str, path: Path | None, *requests: bytes) -> tuple[list[str], list[str]]:
    """Return the answers of node 3 to SDO requests, and what is reported, in one life of a rig."""
    on_bus = outside(interface="virtual", channel=channel)
    settings = drive_settings(RIGS / "probe-z.toml", on_bus, [], [])
    lines: list[str] = []
    with (
        can.Bus(channel, interface="virtual") as master,
        DriveServer(settings, REAL, lines.append, store=path) as server,
    ):
        for data in requests:
            master.send(can.Message(arbitration_id=0x603, data=data, is_extended_id=False))
            server.run(10 * MS)
        heard = list(iter(lambda: master.recv(0.0), None))
    answers = [bytes(each.data).hex() for each in heard if each.arbitration_id == 0x583]
    return answers, [line for line in lines if "parameters written" in line]


@pytest.mark.long
def test_what_a_master_stores_is_in_a_new_file_and_in_the_next_life(tmp_path: Path) -> None:
    """1017 becomes 500 ms and is stored by 1010:1 (CiA 301); by itself a write is forgotten."""
    read, write = bytes.fromhex("4017100000000000"), bytes.fromhex("2b171000f4010000")
    path = tmp_path / "of" / "drives.json"
    path.parent.mkdir()
    first, changed = "4b17100000000000", "4b171000f4010000"
    assert life("store-a", path, read, write, read) == ([first, "6017100000000000", changed], [])
    assert not path.exists()
    answers, written = life("store-b", path, read, write, SAVE_ALL)
    assert answers == [first, "6017100000000000", "6010100100000000"]
    assert len(written) == 1
    assert json.loads(path.read_text()) == {"Z": {"1017:00": 500}}
    assert life("store-c", path, read) == ([changed], [])
    assert life("store-d", None, read) == ([first], [])


def test_without_a_folder_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    on_bus = outside(interface="virtual", channel="drive-server-2")
    settings = drive_settings(RIGS / "probe-z.toml", on_bus, [], [])
    with DriveServer(settings, REAL, lambda _: None) as server:
        server.run(MS)
    assert list(tmp_path.iterdir()) == []


def test_only_the_named_axes_are_there_with_their_segments() -> None:
    """Plants stay: a probe may read those of other axes."""
    whole = drive_settings(RIGS / "probe-xyz.toml", outside(), [], [])
    assert not whole.has_kernel
    assert only_axes(whole, []) is whole
    one = only_axes(whole, ["Z"])
    assert list(one.rig.axis) == ["Z"]
    assert list(one.segment) == [whole.rig.axis["Z"].segment]
    assert one.rig.plant == whole.rig.plant
    assert list(only_axes(whole, ["Z", "X"]).rig.axis) == [
        name for name in whole.rig.axis if name in ("X", "Z")
    ]
    assert whose_eds(one).startswith("axis Z (")
    with pytest.raises(UserError, match="no such axis") as refused:
        only_axes(whole, ["X", "Q"])
    assert refused.value.value == "Q"


def test_assignments_and_the_interface_of_the_command_line_are_in_the_settings() -> None:
    found = drive_settings(
        RIGS / "probe-z.toml", outside(interface="virtual", channel="x", bitrate=500_000), [],
        ["drive:servo.input_delay_us=7"],
    )  # fmt: skip
    (segment,) = found.segment.values()
    made: Any = segment
    assert (made.interface, made.channel, made.bitrate) == ("virtual", "x", 500_000)
    drive: Any = found.rig.drive["servo"]
    assert drive.input_delay_us == 7


def test_the_options_of_the_interface_are_above_assignments() -> None:
    """`--channel` is for this call, also where `--set` or the rig name another one."""
    given = ["bus:can1.channel=other", "bus:can1.bitrate=125000"]
    found = drive_settings(
        RIGS / "probe-z.toml", outside(interface="virtual", channel="own"), [], given
    )
    (segment,) = found.segment.values()
    made: Any = segment
    assert (made.interface, made.channel, made.bitrate) == ("virtual", "own", 125_000)


def test_an_eds_is_of_one_kind_of_drive(tmp_path: Path) -> None:
    """Lines end with CR and LF; axes with different drives have no common one."""
    same = drive_settings(RIGS / "probe-xyz.toml", outside(), [], [])
    path = write_eds(same, tmp_path / "z.eds")
    content = path.read_bytes()
    assert content.count(b"\r\n") == content.count(b"\n") > 0
    assert b"FileName=z.eds" in content
    rig = tmp_path / "rig.toml"
    rig.write_text(
        f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n'
        '[drive.other]\nlacks = "60FD"\n[axis.Y]\ndrive = "other"\n',
        encoding="utf-8",
    )
    with pytest.raises(UserError, match="different drives") as refused:
        write_eds(drive_settings(rig, outside(), [], []), tmp_path / "y.eds")
    assert refused.value.hint == "--axis NAME"
    assert not (tmp_path / "y.eds").exists()
    assert write_eds(drive_settings(rig, outside(), ["Y"], []), tmp_path / "y.eds").exists()


def test_a_simulated_segment_has_no_master_outside() -> None:
    for rig, hint in (
        ("probe-z", "name a CAN interface"),
        ("probe-z-ethercat", "--interface ecat"),
    ):
        settings = drive_settings(RIGS / f"{rig}.toml", outside(), [], [])
        with pytest.raises(UserError, match="is simulated") as refused:
            DriveServer(settings, REAL, lambda _: None)
        assert hint in str(refused.value.hint)


def test_all_axes_that_a_written_eds_fits_are_named_with_their_drives(tmp_path: Path) -> None:
    """In the order of the rig, each with its own drive and that drive's profile."""
    rig = tmp_path / "rig.toml"
    rig.write_text(
        f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n'
        '[drive.other]\nprofile = "akd-like"\n[axis.Y]\ndrive = "other"\n',
        encoding="utf-8",
    )
    whole = drive_settings(rig, outside(), [], [])
    words = {"X": "axis X (servo, profile generic)", "Y": "axis Y (other, profile akd-like)",
             "Z": "axis Z (servo, profile generic)"}  # fmt: skip
    assert whose_eds(whole) == ", ".join(words[name] for name in whole.rig.axis)
    for names in (["Z"], ["X", "Z"], ["Y"]):
        chosen = only_axes(whole, names)
        assert whose_eds(chosen) == ", ".join(words[name] for name in names)
