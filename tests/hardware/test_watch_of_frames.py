"""The lines of `axisrig drive` about frames on two segments: NMT, SYNC, EMCY, aborts, changes."""

from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.tools.virtual_drive.watch import Watcher
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def node(number: int) -> Any:
    return SimpleNamespace(
        node_id=number,
        nmt_state=SimpleNamespace(name="PRE_OPERATIONAL"),
        state=State.SWITCH_ON_DISABLED,
        image=ProcessImage(),
        profile=SimpleNamespace(units_per_mm=1000),
    )


class Watched:
    """Z with node 3 on can1, X with node 3 on can2, Y with node 4 there; and the lines."""

    def __init__(self, folder: Path | None = None) -> None:
        places = {"Z": "can1", "X": "can2", "Y": "can2"}
        axes = {name: SimpleNamespace(segment=on, plant=name) for name, on in places.items()}
        settings: Any = SimpleNamespace(rig=SimpleNamespace(axis=axes))
        self.nodes = {"Z": node(3), "X": node(3), "Y": node(4)}
        self.whole: list[str] = []
        self.opened = ExitStack()
        plant: Any = None
        self.watch = Watcher(settings, self.nodes, plant, self.whole.append, folder, self.opened)

    def frame(self, ms: float, segment: str, can_id: int, data: str = "", **more: Any) -> None:
        made: Any = data_frame(can_id, bytes.fromhex(data))
        is_error = more.pop("is_error", False)
        if more:
            fields = {"arbitration_id": can_id, "data": made.data, "is_extended_id": False,
                      "is_remote_frame": False}  # fmt: skip
            made = SimpleNamespace(**{**fields, **more})
        self.watch(round(ms * MS), segment, made, is_error)

    @property
    def lines(self) -> list[str]:
        """Without their instants, words apart by one space."""
        return [" ".join(line.split()[2:]) for line in self.whole]


@pytest.mark.parametrize(
    ("segment", "data", "line"),
    [
        ("can1", "01 00", "NMT start, all nodes"),
        ("can1", "80 03", "Z NMT enter pre-operational, node 3"),
        ("can2", "80 03", "X NMT enter pre-operational, node 3"),
        ("can2", "02 04", "Y NMT stop, node 4"),
        ("can1", "81 04", "NMT reset node, node 4"),  # of another segment
        ("can2", "82 7F", "NMT reset communication, node 127"),
        ("can2", "55 03", "X NMT unknown command 85, node 3"),
        ("can1", "01", None),
        ("can1", "01 03 00", None),
    ],
)
def test_a_command_of_nmt_names_the_axis_of_its_segment(
    segment: str, data: str, line: str | None
) -> None:
    """CiA 301: identifier 0, command and node, 0 for all."""
    watched = Watched()
    watched.frame(1, segment, 0, data)
    assert watched.lines == ([] if line is None else [line])


def test_a_sync_is_reported_once_and_again_when_it_has_been_away() -> None:
    """Each segment has its own; away is more than half a second."""
    watched = Watched()
    watched.frame(1, "can1", 0x80)
    watched.frame(2, "can1", 0x80)
    watched.frame(3, "can2", 0x80)
    watched.watch.look(502 * MS)
    assert watched.lines == ["SYNC begins on can1", "SYNC begins on can2"]
    watched.watch.look(502 * MS + 1)
    watched.watch.look(503 * MS)
    assert watched.lines[2:] == ["SYNC none on can1 since 0.002000 s"]
    watched.frame(503, "can2", 0x80)
    watched.frame(504, "can1", 0x80)
    watched.watch.look(1003 * MS)
    assert watched.lines[3:] == ["SYNC begins on can1"]
    watched.watch.look(1004 * MS)
    assert watched.lines[4:] == ["SYNC none on can2 since 0.503000 s"]


def test_error_frames_and_frames_of_others() -> None:
    """Frames of 29 bits and remote frames are of no drive; an error frame has a line of its own."""
    watched = Watched()
    emergency = "11 86 21 00 00 00 00 00"
    watched.frame(1, "can1", 0x83, emergency, is_extended_id=True)
    watched.frame(2, "can1", 0x83, emergency, is_remote_frame=True)
    watched.frame(3, "can1", 0x85, emergency)  # no node 5
    watched.frame(4, "can1", 0x84, emergency)  # node 4 is on can2
    watched.frame(5, "can1", 0x83, emergency[:-3])
    watched.frame(6, "can1", 0x583, "60 60 60 00 00 00 00 00")  # an answer that is no abort
    watched.frame(7, "can1", 0x603, "80 60 60 00 01 00 00 0F")  # a question
    for short in ("", "80", "80 60 60 00 30 00 09"):  # no such message is that short
        watched.frame(7, "can1", 0x583, short)
    for wrong in ("", "01", "01 03 00"):
        watched.frame(7, "can1", 0x000, wrong)
    watched.frame(7, "can1", 0x083)
    assert watched.lines == []
    watched.frame(8, "can2", 0x80, is_error=True)
    assert watched.lines == ["bus error frame on can2"]
    watched.frame(9, "can2", 0x84, emergency)
    assert watched.lines[1].startswith("Y EMCY 0x8611")
    watched.frame(10, "can2", 0x583, "80 0A 1A 02 00 00 02 06")
    assert watched.lines[2].startswith("X SDO abort of 0x1A0A:02 with 0x06020000")


def test_what_changes_is_reported_with_the_frame_that_comes_after_it(tmp_path: Path) -> None:
    """Communication, mode and state, in this order; a table has the same."""
    watched = Watched(tmp_path)
    with watched.opened:
        watched.frame(1, "can1", 0x81)
        changed = watched.nodes["X"]
        changed.nmt_state = SimpleNamespace(name="OPERATIONAL")
        changed.state, changed.image.mode = State.READY_TO_SWITCH_ON, 8
        changed.image.controlword = 0x0006
        watched.frame(2, "can1", 0x81)
        watched.frame(3, "can1", 0x81)
    assert watched.lines == [
        "X NMT PRE_OPERATIONAL -> OPERATIONAL",
        "X mode 0 -> 8 (6060)",
        "X state SWITCH_ON_DISABLED -> READY_TO_SWITCH_ON (6040 = 0x0006)",
    ]
    rows = (tmp_path / "events.csv").read_text(encoding="utf-8").splitlines()
    assert rows[:2] == ["time_ns,axis,kind,text", "2000000,X,NMT,PRE_OPERATIONAL -> OPERATIONAL"]
    assert len(rows) == 4
    latches = (tmp_path / "latches.csv").read_text(encoding="utf-8").splitlines()
    assert latches == ["time_ns,axis,probe,object,units,latched_mm,contact_ns,contact_mm"]
