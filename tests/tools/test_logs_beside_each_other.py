"""Logs of a run with buses and lines, notes between error frames, and nodes of another rig."""

import struct
from pathlib import Path

import pytest
from tests.tools.test_words_of_lines import FPWR, frame

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.bus_log.bus_log import logs_of, tell_log
from axisrig.bench.tools.bus_log.canopen.bus_words import NOBODYS, Names
from axisrig.bench.tools.bus_log.canopen.mapping import LoggedPdos
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import is_line, is_timeless, messages_of
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
EC1, EC2 = (f"p-a{SEGMENT_MARK}ec{number}.pcapng" for number in (1, 2))
CAN1, CAN2 = (f"p-a{SEGMENT_MARK}can{number}.pcap" for number in (1, 2))


@pytest.mark.parametrize(
    ("there", "found"),
    [
        (["p-a.blf"], ["p-a.blf"]),
        (["p-a.blf", EC2, EC1], ["p-a.blf", EC1, EC2]),
        ([CAN2, CAN1, EC1], [CAN1, CAN2, EC1]),
        ([EC2, EC1], [EC1, EC2]),
        # Of runs whose names begin alike none is that of the other
        (["p-a.log", f"p-ab{SEGMENT_MARK}ec1.pcapng", "p-ab.blf"], ["p-a.log"]),
        ([f"p-ab{SEGMENT_MARK}can1.pcap", EC1], [EC1]),
    ],
)
def test_the_logs_of_lines_are_behind_those_of_buses(
    tmp_path: Path, there: list[str], found: list[str]
) -> None:
    (tmp_path / "bus").mkdir()
    for name in there:
        (tmp_path / "bus" / name).touch()
    assert [path.name for path in logs_of(tmp_path, "p-a")] == found
    with pytest.raises(UserError, match="left no bus log"):
        logs_of(tmp_path, "p-b")


def bus(folder: Path, *rows: tuple[int, str]) -> Path:
    """A log of candump: ms and frame of each row."""
    path = folder / "p-a.log"
    path.write_text("".join(f"({ms / 1e3:.6f}) can1 {frame}\n" for ms, frame in rows))
    return path


def line(folder: Path) -> Path:
    path = folder / EC1
    file = PcapngFile(path, ["ec1"])
    file.add(5 * MS, 0, frame((FPWR, 1001, 0x0120, struct.pack("<H", 2), 1)))
    file.stop()
    return path


ERROR, BEAT = "20000088#0000080000000000", "703#05"


@pytest.mark.parametrize(
    ("only", "of_bus", "of_line"),
    [((), True, True), (("heartbeat",), True, False)],
)
def test_buses_and_lines_each_say_where_nothing_of_them_is_shown(
    tmp_path: Path, only: tuple[str, ...], of_bus: bool, of_line: bool
) -> None:
    logs = [bus(tmp_path, (1, BEAT)), line(tmp_path)]
    for order in (logs, logs[::-1]):
        shown = list(tell_log(order, None, Selection(only=only)))
        nothing = [text for text in shown if text.startswith("no frame")]
        empty = [path for path, is_shown in zip(logs, (of_bus, of_line), strict=True)
                 if not is_shown]  # fmt: skip
        assert [str(path) in text for path, text in zip(empty, nothing, strict=True)] == (
            [True] * len(empty)
        )
        assert len(shown) == 2
        assert ("can1" in shown[0], "ec1" in shown[1]) == (of_bus, True)
        window = Selection(from_ms=900.0)
        assert len([t for t in tell_log(order, None, window) if t.startswith("no frame")]) == 2


def test_a_note_is_between_the_error_frames_that_it_is_about(tmp_path: Path) -> None:
    """Two at 5 s and 5.01 s, then another recording in the same file: two at 1 s and one beat."""
    rows = [(5000, ERROR), (5010, ERROR), (1000, ERROR), (1010, ERROR), (1020, BEAT)]
    found = [" ".join(text.split()) for text in tell_log([bus(tmp_path, *rows)], None, Selection())]
    assert found[:3] == [
        "5000.000 can1 error frame 2 times until 5010.000 ms",
        "the times of the log go back by 4010.000 ms here",
        "1000.000 can1 error frame 2 times until 1010.000 ms",
    ]
    assert len(found) == 4
    assert found[3].startswith("1020.000 can1 703 ")


SDO = (
    (0x609, "2f001a0001000000"), (0x589, "60001a0000000000"),  # 1A00:00 = 1
    (0x609, "23001a0110004160"), (0x589, "60001a0100000000"),  # 1A00:01 = 6041:00, 16 bits
)  # fmt: skip


@pytest.mark.parametrize("has_rig", [True, False])
def test_a_telegram_that_a_master_has_mapped_on_a_node_of_no_rig_says_so(has_rig: bool) -> None:
    """Node 9 has statusword in TPDO1 by the SDO traffic of the log; the rig has node 3."""
    names = Names(settings_of(RIGS / "probe-z.toml", []) if has_rig else None)
    for can_id, text in SDO:
        sent = data_frame(can_id, bytes.fromhex(text))
        names.follow("can1", sent, dissect(sent))
    sent = data_frame(0x189, bytes.fromhex("3700"))
    described = names.describe("can1", sent, names.follow("can1", sent, dissect(sent)))
    assert described.name == "9.TPDO1"
    assert "0x0037" in described.text
    assert described.text.endswith(f", {NOBODYS}") is has_rig
    assert {"9", "tpdo1", "9.tpdo1", "6041", "6041:0"} <= described.tags


OWN = (MappedObject(0x2000, 1, 16, True, ""), MappedObject(0x6041, 0, 16, False, ""))
"""A rig takes the object of a maker for a signed one; no table of ours has it."""


def telegram(*written: tuple[int, int, int]) -> Telegram | None:
    """TPDO2 of node 3 after a master has written some objects."""
    pdos = LoggedPdos({("can1", 3): {"TPDO2": Telegram("TPDO2", 1, 0, OWN)}})
    for index, sub, value in written:
        pdos.note("can1", 3, index, sub, value)
    found = pdos.find("can1", 0x283, False)
    assert found is not None
    return found.telegram


def test_entries_that_a_master_leaves_are_those_of_the_rig() -> None:
    """Also their number (1A01:00), and which objects are signed."""
    for written, objects in (
        ((), OWN),
        (((0x1A01, 2, OWN[0].entry),), (OWN[0], OWN[0])),
        (((0x1A01, 1, OWN[1].entry), (0x1A01, 2, OWN[0].entry)), (OWN[1], OWN[0])),
        (((0x1A01, 0, 1),), OWN[:1]),
        (((0x1A01, 0, 3), (0x1A01, 3, OWN[0].entry)), (*OWN, OWN[0])),
        (((0x1A01, 0, 0),), ()),
    ):  # fmt: skip
        found = telegram(*written)
        assert found is not None, written
        assert found.objects == objects
    assert telegram((0x1A01, 0, 3)) is None  # nobody has said what the third one is


def test_a_capture_without_a_packet_is_one_of_a_line_in_which_nothing_is(tmp_path: Path) -> None:
    path = tmp_path / EC1
    PcapngFile(path, ["ec1"]).stop()
    assert is_line(path)
    (text,) = tell_log([path], None, Selection())
    assert text.startswith("no frame among those of ")


NO_TIMES = "the log has no times"


@pytest.mark.parametrize(
    ("times", "has_times"),
    [
        (("(000.000000)", "(000.010000)"), True),  # -t z begins with 0
        (("(000.000000)", "(000.000000)", "(000.020000)"), True),
        (("(1760500000.000000)", "(1760500000.010000)"), True),
        (("", ""), False),
    ],
)
def test_a_log_of_candump_has_times_where_one_is_not_0(
    tmp_path: Path, times: tuple[str, ...], has_times: bool
) -> None:
    path = tmp_path / "screen.log"
    path.write_text("".join(f" {time}  can1  703   [1]  05\n" for time in times))
    assert is_timeless(path) is not has_times
    first, *_ = tell_log([path], None, Selection(is_all=True))
    assert first.startswith(NO_TIMES) is not has_times


FORMS = {
    ".log": "(1.000000) can0 703#05\n",
    ".txt": "  can0  703   [1]  05\n",
    ".asc": "date Mon Nov 2 10:00:00.000 am 2026\nbase hex  timestamps absolute\n"
            "internal events logged\n   1.000000 1  703             Rx   d 1 05\n",
    ".trc": ";$FILEVERSION=2.1\n;$STARTTIME=43008.920986006946\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n"
            "1 1000.000 DT 1 0703 Rx - 1 05\n",
}  # fmt: skip


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"], ids=["plain", "marked"])
@pytest.mark.parametrize("suffix", FORMS)
def test_a_text_may_begin_with_the_mark_of_utf_8(tmp_path: Path, suffix: str, mark: bytes) -> None:
    """Windows tools write it: it is no sign of the first line, by which a text is known."""
    path = tmp_path / f"some{suffix}"
    path.write_bytes(mark + FORMS[suffix].encode())
    (one,) = messages_of([path])
    assert (one.arbitration_id, bytes(one.data)) == (0x703, b"\x05")
