"""`axisrig bus`: each kind of frame in words, which frames are shown, which log is meant.

Frames are written by CiA 301, 305 and 402-2; the words are those of the tables.
"""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from canopen.objectdictionary import INTEGER16, UNSIGNED16, UNSIGNED32, ObjectDictionary, ODVariable

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.bus_log import find_log, logs_of, tell_log
from axisrig.bench.tools.bus_log.canopen.mapping import LoggedPdos
from axisrig.bench.tools.bus_log.canopen.object_words import number_of, value_words
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers, Value
from axisrig.bench.tools.bus_log.choice.channels import Channels
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
NOBODYS = ", of no node of this rig"


@pytest.fixture(scope="module")
def rig() -> Settings:
    """Axis Z is node 3 on can1; 1048576 units are 10 mm."""
    return settings_of(RIGS / "probe-z.toml", [])


def answer(
    folder: Path, frames: Sequence[tuple[float, str]], settings: Settings | None, **words: object
) -> list[str]:
    """Return the words for frames (ms, `segment id#data`), without the time."""
    path = folder / "some.log"
    lines = [f"({ms / 1e3:.6f}) {frame} R\n" for ms, frame in frames]
    path.write_text("".join(lines), encoding="utf-8")
    selection = Selection(**{"is_all": True, **words})  # type: ignore[arg-type]
    return [*tell_log([path], settings, selection)]


@pytest.mark.parametrize(
    ("frame", "name", "text"),
    [
        ("000#0103", "NMT", "start, node 3"),
        ("000#8000", "NMT", "enter pre-operational, all nodes"),
        ("000#8001", "NMT", "enter pre-operational, node 1, of no node of this rig"),
        ("000#8203", "NMT", "reset communication, node 3"),
        ("000#0503", "NMT", "command 5, node 3"),
        ("000#0104", "NMT", "start, node 4" + NOBODYS),
        ("000#01", "NMT", "01"),  # too short for a command
        ("080#", "SYNC", ""),
        ("080#07", "SYNC", "counter 7"),
        ("703#00", "Z.heartbeat", "boot-up"),
        ("703#04", "Z.heartbeat", "stopped"),
        ("703#85", "Z.heartbeat", "operational, toggle bit"),
        ("703#7F", "Z.heartbeat", "pre-operational"),
        ("703#09", "Z.heartbeat", "state 9"),
        ("703#R", "Z.heartbeat", "remote frame"),
        ("183#R", "Z.TPDO1", "remote frame"),
        ("184#R8", "4.TPDO1", "remote frame" + NOBODYS),
        ("603#R", "Z.SDO request", "remote frame"),
        ("704#05", "4.heartbeat", "operational" + NOBODYS),
        ("603#4041600000000000", "Z.SDO request", "upload 0x6041:0 Statusword"),
        ("603#4000200100000000", "Z.SDO request", "upload 0x2000:1"),
        ("603#2100200110000000", "Z.SDO request", "download 0x2000:1, 16 bytes follow"),
        ("583#41002001FF000000", "Z.SDO answer", "upload 0x2000:1, 255 bytes follow"),
        ("583#6000200100000000", "Z.SDO answer", "download 0x2000:1"),
        ("603#0011223344556677", "Z.SDO request", "download segment 11 22 33 44 55 66 77"),
        ("603#0D11000000000000", "Z.SDO request", "download segment 11, the last one"),
        ("583#0911223300000000", "Z.SDO answer", "upload segment 11 22 33, the last one"),
        ("603#6000000000000000", "Z.SDO request", "upload segment"),
        ("583#2000000000000000", "Z.SDO answer", "download segment"),
        ("603#A400200140000000", "Z.SDO request", "block upload 0x2000:1"),
        ("603#C600200110000000", "Z.SDO request", "block download 0x2000:1, 16 bytes follow"),
        ("603#C400200110000000", "Z.SDO request", "block download 0x2000:1"),
        ("603#A300000000000000", "Z.SDO request", "block upload start"),
        ("603#A100000000000000", "Z.SDO request", "block upload end"),
        ("583#A205400000000000", "Z.SDO answer",
         "block download 5 segments taken, next 64 at most"),
        ("603#D534120000000000", "Z.SDO request",
         "block download end, 5 bytes of the last segment unused, CRC 0x1234"),
        ("603#C100000000000000", "Z.SDO request",
         "block download end, 0 bytes of the last segment unused, CRC 0x0000"),
        ("603#DD0A000000000000", "Z.SDO request",
         "block download end, 7 bytes of the last segment unused, CRC 0x000A"),
        ("583#C5FF0A0000000000", "Z.SDO answer",
         "block upload end, 1 byte of the last segment unused, CRC 0x0AFF"),
        ("583#D9EFBE0000000000", "Z.SDO answer",
         "block upload end, 6 bytes of the last segment unused, CRC 0xBEEF"),
        ("603#A200010000000000", "Z.SDO request", "block upload 0 segments taken, next 1 at most"),
        ("603#A27F7F0000000000", "Z.SDO request",
         "block upload 127 segments taken, next 127 at most"),
        ("583#A100000000000000", "Z.SDO answer", "block download end"),
        ("583#A400200140000000", "Z.SDO answer", "block download 0x2000:1"),
        ("583#C600200110000000", "Z.SDO answer", "block upload 0x2000:1, 16 bytes follow"),
        ("583#C400200110000000", "Z.SDO answer", "block upload 0x2000:1"),
        ("603#E000000000000000", "Z.SDO request", "unknown e0 00 00 00 00 00 00 00"),
        ("583#8100000000000000", "Z.SDO answer", "unknown 81 00 00 00 00 00 00 00"),
        ("183#3702", "Z.TPDO1", "37 02 (2 bytes, 8 are mapped)"),
        ("184#3702", "4.TPDO1", "37 02" + NOBODYS),
        ("7E5#0401", "LSS request", "01"),
        ("001#1122", "unknown", "11 22" + NOBODYS),
        ("00000183#3702", "unknown", "37 02" + NOBODYS),  # 29 bits: another frame
    ],
)  # fmt: skip
def test_each_frame_in_words(
    tmp_path: Path, rig: Settings, frame: str, name: str, text: str
) -> None:
    (line,) = answer(tmp_path, [(1, f"can1 {frame}")], rig)
    _, segment, _, rest = line.split(maxsplit=3)
    assert segment == "can1"
    assert [part.strip() for part in (rest[:16], rest[16:])] == [name, text]


def test_the_end_of_an_emergency_has_the_bytes_of_its_maker(tmp_path: Path) -> None:
    (line,) = answer(tmp_path, [(1, "can1 083#1086210102030405")], None)
    assert "3.EMCY" in line
    assert line.endswith(", 01 02 03 04 05")


TIMES = [(1.0, "can1 080#"), (2.0, "can1 183#01"), (3.0, "can1 183#01"), (4.0, "can1 183#02"),
         (5.0, "can2 183#02"), (6.0, "can1 083#0000000000000000"),
         (7.0, "can1 083#0000000000000000"), (8.0, "can1 080#")]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "times"),
    [
        ({}, [1, 2, 3, 4, 5, 6, 7, 8]),
        ({"from_ms": 2.0, "to_ms": 4.0}, [2, 3, 4]),
        ({"from_ms": 2.001, "to_ms": 3.999}, [3]),
        ({"is_all": False}, [1, 2, 4, 5, 6, 7]),  # nothing new at 3 and 8
        ({"is_all": False, "from_ms": 3.0}, [3, 4, 5, 6, 7, 8]),  # the first that is shown is news
        ({"only": ("pdo",), "is_all": False}, [2, 4, 5]),
        ({"only": ("TPDO1", "emcy"), "from_ms": 5.0}, [5, 6, 7]),
        ({"only": ("sync",)}, [1, 8]),
        ({"only": ("3.emcy",)}, [6, 7]),
    ],
)
def test_which_frames_are_shown(tmp_path: Path, words: dict[str, object], times: list[int]) -> None:
    lines = answer(tmp_path, TIMES, None, **words)
    assert [round(float(line.split()[0])) for line in lines] == times


def test_a_log_with_dates_counts_from_its_first_frame(tmp_path: Path) -> None:
    """From 10^8 s on a time is a date: candump writes seconds since 1970."""
    for first_ms, shown in ((1.0e11, 100_000_000_000.0), (1.7e12, 0.0)):
        frames = [(first_ms, "can1 080#"), (first_ms + 250.0, "can1 703#05")]
        times = [float(line.split()[0]) for line in answer(tmp_path, frames, None)]
        assert times == pytest.approx([shown, shown + 250.0], abs=0.01)


@pytest.mark.parametrize(
    ("only", "words"), [((), "no frame among"), (("sdo", "lss"), "no frame for sdo, lss among")]
)
def test_no_frame_to_show_is_said(tmp_path: Path, only: tuple[str, ...], words: str) -> None:
    (line,) = answer(tmp_path, [(1, "can1 080#")], None, only=only, from_ms=2.0)
    assert line.startswith(words)
    assert line.endswith("(see --all)")


@pytest.mark.parametrize(
    ("word", "is_known"),
    [
        ("z", True), ("Z.tpdo4", True), ("tpdo12", True), ("127", True), ("1.sdo", True),
        ("error", True), ("6041:1f", True), ("0x6041", True), ("3.", True),
        ("128", False), ("0", False), ("y", False), ("z.statusword", False), ("4.z", False),
        ("6041:100", False), ("604", False), ("tpdo", True), ("pdo1", False),
    ],
)  # fmt: skip
def test_words_that_ask_for_something(
    tmp_path: Path, rig: Settings, word: str, is_known: bool
) -> None:
    if is_known:
        answer(tmp_path, [(1, "can1 080#")], rig, only=(word,))
    else:
        with pytest.raises(UserError, match="no service, axis, telegram or object"):
            answer(tmp_path, [(1, "can1 080#")], rig, only=(word,))


OBJECTS = [
    # SDO requests of 1A00:0A, 1A00:10, 1A00:01, 100A:0, 1A00:FF to node 3, and its answer to one
    (1.0, "can1 603#40001A0A00000000"), (2.0, "can1 603#40001A1000000000"),
    (3.0, "can1 603#40001A0100000000"), (4.0, "can1 603#400A100000000000"),
    (5.0, "can1 603#40001AFF00000000"), (6.0, "can1 583#43001A1010006460"),
    # Of node 4, an abort of 1A00:0A, and TPDO1 of node 3 with 6041:0 and 6064:0
    (7.0, "can1 584#80001A0A11000906"), (8.0, "can1 183#3702640000000000"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("word", "times"),
    [
        ("1a00", [1, 2, 3, 5, 6, 7]), ("0x1A00", [1, 2, 3, 5, 6, 7]), ("100a", [4]),
        ("1a00:a", [1, 7]), ("1A00:A", [1, 7]), ("0x1a00:a", [1, 7]), ("1a00:10", [2, 6]),
        ("1a00:1", [3]), ("1a00:ff", [5]), ("1a00:0", []), ("100a:0", [4]),
        ("6041:0", [8]), ("6064", [8]), ("6041:1", []),
        ("abort", [7]), ("sdo", [1, 2, 3, 4, 5, 6, 7]), ("4", [7]), ("4.sdo", [7]),
        ("4.abort", [7]), ("z.sdo", [1, 2, 3, 4, 5, 6]), ("3.tpdo1", [8]), ("z", [*range(1, 7), 8]),
    ],
)  # fmt: skip
def test_an_object_is_found_by_index_and_subindex_in_hex(
    tmp_path: Path, rig: Settings, word: str, times: list[int]
) -> None:
    lines = answer(tmp_path, OBJECTS, rig, only=(word,))
    if not times:
        assert lines[0].startswith("no frame for")
        return
    assert [round(float(line.split()[0])) for line in lines] == times


def test_a_segment_has_the_name_of_the_rig_where_its_number_is_of_it() -> None:
    """Numbers count from 0 in the order of the rig; without one, only a single segment is meant."""
    one, three = (
        Channels(list(settings_of(RIGS / name, []).segment), {}, lambda: {0, 1, 7})
        for name in ("probe-z.toml", "distance-5axis.toml")
    )
    channels = (0, 1, 2, 3, -1, None, "can7")
    assert [one.segment(each) for each in channels] == ["can1", "1", "2", "3", "-1", "can1", "can7"]
    assert [three.segment(each) for each in channels] == [
        *("can1", "can2", "can3", "3", "-1", "", "can7")
    ]
    assert [Channels([], {}, set).segment(each) for each in (0, None)] == ["0", ""]


PER_MM = Fraction(1000)


@pytest.mark.parametrize(
    ("key", "bits", "value", "per_mm", "plain", "as_sdo"),
    [
        ((0x6041, 0), 16, 0x0237, None, "0x0237 (operation enabled)", None),
        ((0x1001, 0), 8, 0, None, "0x00", None),
        ((0x6060, 0), 8, 8, None, "8 (cyclic synchronous position)",
         "8 (0x08; cyclic synchronous position)"),
        ((0x1A00, 1), 32, 0x60410010, None, "0x60410010 (6041:0, 16 bit)", None),
        ((0x17FF, 2), 32, 0x60D80120, None, "0x60D80120 (60D8:1, 32 bit)", None),
        ((0x1BFF, 64), 32, 0, None, "0x00000000 (nothing)", None),
        ((0x1A00, 0), 8, 2, None, "2", "2 (0x02)"),
        ((0x1800, 1), 32, 0x183, None, "387", "387 (0x00000183)"),
        ((0x1C00, 1), 32, 0x60410010, None, "1614872592", "1614872592 (0x60410010)"),
        ((0x6064, 0), 32, -1500, PER_MM, "-1500 (-1.500000 mm)",
         "-1500 (0xFFFFFA24; -1.500000 mm)"),
        ((0x6064, 0), 32, -1500, None, "-1500", "-1500 (0xFFFFFA24)"),
        ((0x606C, 0), 32, 1500, PER_MM, "1500", "1500 (0x000005DC)"),
    ],
)  # fmt: skip
def test_values_with_what_they_mean(
    key: tuple[int, int], bits: int, value: int, per_mm: Fraction | None, plain: str,
    as_sdo: str | None,
) -> None:  # fmt: skip
    assert value_words(*key, bits, value, per_mm, hexadecimal=False) == plain
    assert value_words(*key, bits, value, per_mm, hexadecimal=True) == (as_sdo or plain)


@pytest.mark.parametrize(
    ("index", "data", "number"),
    [
        (0x6064, "ffffffff", -1),
        (0x6064, "ffff", 65_535),  # not as long as the object: as it is
        (0x6060, "ff", -1),
        (0x6041, "ffff", 65_535),
        (0x2000, "80", 128),
        (0x1000, "92010200", 0x20192),
    ],
)
def test_the_number_in_the_data_of_an_sdo(index: int, data: str, number: int) -> None:
    assert number_of(index, 0, bytes.fromhex(data)) == number


def test_objects_of_a_maker_have_the_sign_of_its_eds_where_the_length_fits() -> None:
    od = ObjectDictionary()
    for index, kind in ((0x3001, INTEGER16), (0x3002, UNSIGNED16), (0x6064, UNSIGNED32)):
        od.add_object(ODVariable(f"object {index:X}", index, 0))
        od[index].data_type = kind
    for index, data, number in (
        (0x3001, "feff", -2), (0x3001, "fe", 254), (0x3001, "feffffff", 0xFFFF_FFFE),
        (0x3002, "feff", 0xFFFE), (0x3003, "feff", 0xFFFE),
        (0x6064, "ffffffff", -1),  # what CiA 402 says comes before an EDS
    ):  # fmt: skip
        assert number_of(index, 0, bytes.fromhex(data), od) == number, (index, data)


def test_the_log_of_a_run_is_the_first_kind_there_is(tmp_path: Path) -> None:
    """One file, or the pcap logs of each segment of that run and of no other one."""
    bus = tmp_path / "bus"
    bus.mkdir()
    with pytest.raises(UserError, match="left no bus log"):
        logs_of(tmp_path, "plan.one")
    for name in ("plan.one", "plan.one2"):
        for segment in ("can2", "can1"):
            (bus / f"{name}@{segment}.pcap").touch()
    found = [path.name for path in logs_of(tmp_path, "plan.one")]
    assert found == ["plan.one@can1.pcap", "plan.one@can2.pcap"]
    (bus / "plan.one.log").touch()
    assert [path.name for path in logs_of(tmp_path, "plan.one")] == ["plan.one.log"]


def test_a_file_that_is_no_log_is_refused_and_a_folder_of_drives_has_its_one(
    tmp_path: Path,
) -> None:
    for name in ("bus.csv", "missing.log"):
        (tmp_path / "bus.csv").touch()
        with pytest.raises(UserError, match="no bus log that can be read"):
            find_log(tmp_path / name, None)
    (tmp_path / "SOME.LOG").touch()
    assert find_log(tmp_path / "SOME.LOG", None) == ([tmp_path / "SOME.LOG"], None)
    (tmp_path / "bus.blf").touch()
    assert find_log(tmp_path, None) == ([tmp_path / "bus.blf"], None)


PLACE = "002001"  # object 2000:1


@pytest.mark.parametrize(
    ("frames", "value"),
    [
        # Expedited: the answer of the server confirms a download, an upload is in the answer
        ([("603", f"2B{PLACE}34120000"), ("583", f"60{PLACE}00000000")], "3412"),
        ([("603", f"2B{PLACE}34120000")], None),
        ([("603", f"2B{PLACE}34120000"), ("583", "6001200100000000")], None),  # of another object
        ([("603", f"40{PLACE}00000000"), ("583", f"4B{PLACE}34120000")], "3412"),
        ([("603", f"40{PLACE}00000000"), ("583", "4B01200134120000")], None),
        ([("603", f"2B{PLACE}34120000"), ("583", f"80{PLACE}11000906")], None),
        # In segments: 9 bytes, of the last segment 5 are unused (n = 5, c = 1)
        ([("603", f"21{PLACE}09000000"), ("583", f"60{PLACE}00000000"),
          ("603", "0001020304050607"), ("583", "2000000000000000"),
          ("603", "1B08090000000000"), ("583", "3000000000000000")], "010203040506070809"),
        ([("603", f"21{PLACE}09000000"), ("583", f"60{PLACE}00000000"),
          ("603", "0001020304050607"), ("583", "2000000000000000")], None),
        ([("603", f"40{PLACE}00000000"), ("583", f"41{PLACE}09000000"),
          ("603", "6000000000000000"), ("583", "0001020304050607"),
          ("603", "7000000000000000"), ("583", "1B08090000000000")], "010203040506070809"),
        ([("603", f"40{PLACE}00000000"), ("583", f"41{PLACE}09000000"),
          ("603", "6000000000000000"), ("583", f"80{PLACE}11000906"),
          ("583", "1B08090000000000")], None),
    ],
)  # fmt: skip
def test_the_value_that_an_object_has_after_a_transfer(
    frames: list[tuple[str, str]], value: str | None
) -> None:
    """CiA 301, SDO protocols; beside it another node is in the midst of a transfer of its own."""
    transfers, found = Transfers(), []
    for can_id, data in [("604", f"21{PLACE}09000000"), ("604", "0011111111111111"), *frames]:
        frame = data_frame(int(can_id, 16), bytes.fromhex(data))
        _, done = transfers.take("can1", frame.data, dissect(frame))
        found += [done] if done is not None else []
    expected = [] if value is None else [Value(0x2000, 1, bytes.fromhex(value))]
    assert found == expected


def test_a_frame_is_of_who_sends_it_before_those_who_receive_it() -> None:
    """0x183 is TPDO1 of node 3, and node 4 has its RPDO1 set to it; another segment has neither."""
    pdos = LoggedPdos({})
    pdos.note("can1", 4, 0x1400, 1, 0x183)
    pdos.note("can1", 4, 0x1600, 0, 0)
    for _ in range(2):
        found = pdos.find("can1", 0x183, False)
        assert found is not None
        assert (found.node, found.name) == (4, "RPDO1")
        pdos.note("can1", 3, 0x1A00, 0, 0)
        pdos.note("can1", 3, 0x1800, 1, 0x183)
        found = pdos.find("can1", 0x183, False)
        assert found is not None
        assert (found.node, found.name) == (3, "TPDO1")
        assert pdos.find("can2", 0x183, False) is None
        assert pdos.find("can1", 0x183, True) is None
        pdos.forget("can1", 3)
    for count, is_known in ((64, True), (65, False)):
        for sub in range(1, 66):
            pdos.note("can1", 3, 0x1A00, sub, 0x60FD0108)
        pdos.note("can1", 3, 0x1A00, 0, count)
        found = pdos.find("can1", 0x183, False)
        assert found is not None
        assert (found.telegram is not None) is is_known
