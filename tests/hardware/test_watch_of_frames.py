"""What `axisrig drive` says of frames on two segments, and of drives of SERCOS."""

from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.tools.virtual_drive.watch import EthercatWatcher, Watcher
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
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


class Seen:
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
    seen = Seen()
    seen.frame(1, segment, 0, data)
    assert seen.lines == ([] if line is None else [line])


def test_a_sync_is_reported_once_and_again_when_it_has_been_away() -> None:
    """Each segment has its own; away is more than half a second."""
    seen = Seen()
    seen.frame(1, "can1", 0x80)
    seen.frame(2, "can1", 0x80)
    seen.frame(3, "can2", 0x80)
    seen.watch.look(502 * MS)
    assert seen.lines == ["SYNC begins on can1", "SYNC begins on can2"]
    seen.watch.look(502 * MS + 1)
    seen.watch.look(503 * MS)
    assert seen.lines[2:] == ["SYNC none on can1 since 0.002000 s"]
    seen.frame(503, "can2", 0x80)
    seen.frame(504, "can1", 0x80)
    seen.watch.look(1003 * MS)
    assert seen.lines[3:] == ["SYNC begins on can1"]
    seen.watch.look(1004 * MS)
    assert seen.lines[4:] == ["SYNC none on can2 since 0.503000 s"]


def test_error_frames_and_frames_of_others() -> None:
    """Frames of 29 bits and remote frames are of no drive; an error frame is told as such."""
    seen = Seen()
    emergency = "11 86 21 00 00 00 00 00"
    seen.frame(1, "can1", 0x83, emergency, is_extended_id=True)
    seen.frame(2, "can1", 0x83, emergency, is_remote_frame=True)
    seen.frame(3, "can1", 0x85, emergency)  # no node 5
    seen.frame(4, "can1", 0x84, emergency)  # node 4 is on can2
    seen.frame(5, "can1", 0x83, emergency[:-3])
    seen.frame(6, "can1", 0x583, "60 60 60 00 00 00 00 00")  # an answer that is no abort
    seen.frame(7, "can1", 0x603, "80 60 60 00 01 00 00 0F")  # a question
    assert seen.lines == []
    seen.frame(8, "can2", 0x80, is_error=True)
    assert seen.lines == ["bus error frame on can2"]
    seen.frame(9, "can2", 0x84, emergency)
    assert seen.lines[1].startswith("Y EMCY 0x8611")
    seen.frame(10, "can2", 0x583, "80 0A 1A 02 00 00 02 06")
    assert seen.lines[2].startswith("X SDO abort of 0x1A0A:02 with 0x06020000")


def test_what_changes_is_reported_with_the_frame_that_comes_after_it(tmp_path: Path) -> None:
    """Communication, mode and state, in this order; a table has the same."""
    seen = Seen(tmp_path)
    with seen.opened:
        seen.frame(1, "can1", 0x81)
        changed = seen.nodes["X"]
        changed.nmt_state = SimpleNamespace(name="OPERATIONAL")
        changed.state, changed.image.mode = State.READY_TO_SWITCH_ON, 8
        changed.image.controlword = 0x0006
        seen.frame(2, "can1", 0x81)
        seen.frame(3, "can1", 0x81)
    assert seen.lines == [
        "X NMT PRE_OPERATIONAL -> OPERATIONAL",
        "X mode 0 -> 8 (6060)",
        "X state SWITCH_ON_DISABLED -> READY_TO_SWITCH_ON (6040 = 0x0006)",
    ]
    rows = (tmp_path / "events.csv").read_text(encoding="utf-8").splitlines()
    assert rows[:2] == ["time_ns,axis,kind,text", "2000000,X,NMT,PRE_OPERATIONAL -> OPERATIONAL"]
    assert len(rows) == 4
    latches = (tmp_path / "latches.csv").read_text(encoding="utf-8").splitlines()
    assert latches == ["time_ns,axis,probe,object,units,latched_mm,contact_ns,contact_mm"]


class Scaled(SercosDrive):
    """A drive of SERCOS as a master has set it: 400 units in 2 turns of 5 mm."""

    state = State.OPERATION_ENABLED

    def __init__(self) -> None:
        instants = [SimpleNamespace(instant_ns=ms * MS) for ms in (3, 4, 5, 6)]
        probes = [
            SimpleNamespace(latches={True: up, False: down})
            for up, down in (instants[:2], instants[2:])
        ]
        own: Any = self
        own.states = SimpleNamespace(state=AlState.OP, code=0)
        image = ProcessImage()
        image.feed, image.feed_shaft = 400, 2
        own.front = SimpleNamespace(control=0xE000)
        own.servo = SimpleNamespace(touch_probe=SimpleNamespace(probes=probes), image=image)
        own.profile = SimpleNamespace(lead_um=5000, units_per_mm=1.0)


def test_a_drive_of_sercos_has_its_own_words_and_its_scaling() -> None:
    """S-0-0032, S-0-0134, S-0-0130 to 0133; 40 units are 1 mm."""
    axis = SimpleNamespace(plant="z", probe_1=None, probe_2=None)
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    plant: Any = SimpleNamespace(probes={})
    drive, lines = Scaled(), list[str]()
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, {"Z": drive}, plant, lines.append, None, opened)
        drive.image.mode = 11
        drive.state = State.FAULT  # type: ignore[misc]
        for number, edge in ((1, "positive"), (1, "negative"), (2, "positive"), (2, "negative")):
            setattr(drive.image, f"latch_{number}_{edge}", 40 * number)
            setattr(drive.image, f"count_{number}_{edge}", 1)
        watch.look(9 * MS)
    assert [" ".join(line.split()[3:]) for line in lines] == [
        "mode 0 -> 11 (S-0-0032)",
        "state OPERATION_ENABLED -> FAULT (S-0-0134 = 0xE000)",
        "latch probe 1, S-0-0130 = 40 = 1.000000 mm",
        "latch probe 1, S-0-0131 = 40 = 1.000000 mm",
        "latch probe 2, S-0-0132 = 80 = 2.000000 mm",
        "latch probe 2, S-0-0133 = 80 = 2.000000 mm",
    ]
    assert [line.split()[0] for line in lines[2:]] == [f"0.00{ms}000" for ms in (3, 4, 5, 6)]
