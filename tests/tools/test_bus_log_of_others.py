"""`axisrig bus` with logs of other tools: forms, times, channels, names of the maker's objects."""

import gzip
import struct
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path

import can
import pytest
from tests.tools.captures import RESOLUTION, interface, packet, section

from axisrig.bench.bus.can.logs import asc_writer
from axisrig.bench.cli.guard import needs_progress
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.bus_log import find_log, tell_log
from axisrig.bench.tools.bus_log.choice.channels import Channels, given_channels
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import in_order, messages_of
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
HEAD = "date {day} 09:15:00.000 2026\nbase hex  timestamps {times}\ninternal events logged\n"
ENGLISH = "Mon Mar 16"
CANDUMP = "(1760500000.010000) can0 703#00\n(1760500000.020000) can0 603#4000100000000000\n"

Frames = list[tuple[float, str, int, str]]
"""Time in ms, segment, identifier, data."""


def asc(times: str, *lines: str, day: str = ENGLISH) -> str:
    """Return an ASC log with these lines."""
    return HEAD.format(day=day, times=times) + "".join(f"{line}\n" for line in lines)


def lines_of(path: Path, settings: Settings | None = None, **words: object) -> list[str]:
    """Return what is shown of a log."""
    selection = Selection(**{"is_all": True, **words})  # type: ignore[arg-type]
    return [*tell_log([path], settings, selection)]


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., Path]:
    """Write a log."""

    def write(name: str, text: str | bytes, encoding: str = "utf-8") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return write


def frames_of(path: Path) -> Frames:
    """Return the frames of a log; those with dates count from the first one."""
    messages = list(messages_of([path]))
    first = messages[0].timestamp
    origin = first if first > 1e8 else 0.0
    return [
        (
            round((message.timestamp - origin) * 1e3, 3),
            "" if message.channel is None else str(message.channel),
            message.arbitration_id,
            bytes(message.data).hex(),
        )
        for message in messages
    ]


UPLOAD = (0x603, "4000100000000000")
BOOT = (0x703, "00")
RX, TX = "703 Rx d 1 00", "603 Tx d 8 40 00 10 00 00 00 00 00"


@pytest.mark.parametrize(
    ("times", "lines", "expected"),
    [
        ("absolute", (f"0.010000 1 {RX}", f"0.020000 1 {TX}"), [10, 20]),
        # asc2log of can-utils adds relative times in the same way
        ("relative", (f"0.010000 1 {RX}", f"0.010000 1 {TX}", f"0.001000 1 {RX}"), [10, 20, 21]),
        # An event that is no frame has its part of the time too
        ("relative", (f"0.010000 1 {RX}", "0.005 CAN 1 Status:x", f"0.010000 2 {TX}"), [10, 25]),
        ("absolute", (f"-0.020000 1 {RX}", f"-0.010000 1 {TX}", f"0.001 1 {RX}"), [-20, -10, 1]),
        # A request to send is no frame yet: TxRq, then Tx
        ("absolute", (f"0.01 1 {TX.replace('Tx', 'TxRq')}", f"0.011 1 {TX}"), [11]),
        ("relative", (f"0.01 1 {RX}", f"0.002 1 {TX.replace('Tx', 'TxRq')}", f"0.003 1 {TX}"),
         [10, 15]),
        ("absolute", ("// some words", "Begin Triggerblock", "0.000000 Start of measurement",
                      f"0.01 1 {RX}", "// base hex  timestamps relative", f"0.02 1 {TX}",
                      "End TriggerBlock"), [10, 20]),
    ],
)  # fmt: skip
def test_times_of_an_asc_log(
    written: Callable[..., Path], times: str, lines: tuple[str, ...], expected: list[float]
) -> None:
    found = frames_of(written("some.asc", asc(times, *lines)))
    assert [time_ms for time_ms, *_ in found] == expected


def test_an_asc_log_without_the_line_that_ends_its_head_has_its_first_frame(
    written: Callable[..., Path],
) -> None:
    text = asc("absolute", f"0.01 1 {RX}").replace("internal events logged\n", "")
    assert frames_of(written("some.asc", text)) == [(10.0, "0", *BOOT)]


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8", "utf-8-sig"])
def test_an_asc_log_with_a_german_date_is_read(written: Callable[..., Path], encoding: str) -> None:
    """The sign after a foreign one is there too, were it the end of its line."""
    text = asc("absolute", "// Prüfung Ü", f"0.01 1 {RX}", "// ÄÖ", f"0.02 1 {TX}", day="Mo Mär 16")
    assert frames_of(written("some.asc", text, encoding)) == [
        (10.0, "0", *BOOT),
        (20.0, "0", *UPLOAD),
    ]


SCREEN = "  can0  703   [1]  00\n  can0  603   [8]  40 00 10 00 00 00 00 00\n"
TRC = """;$FILEVERSION=1.1
;$STARTTIME=43008.920986006946
     1)        1.2  Rx         0703  1  00
     2)       11.2  Tx         0603  8  40 00 10 00 00 00 00 00
"""


@pytest.mark.parametrize(
    ("name", "text", "channel"),
    [
        ("a.log", CANDUMP, "can0"),
        ("a.txt", CANDUMP, "can0"),
        ("a.log.gz", gzip.compress(CANDUMP.encode(), mtime=0), "can0"),
        ("a.LOG", CANDUMP.replace("\n", "\r\n"), "can0"),
        ("screen.log", SCREEN.replace("  can0", " (1760500000.010)  can0", 1)
         .replace("\n  can0", "\n (1760500000.020)  can0"), "can0"),
        ("screen.txt", SCREEN.replace("  can0", " (2026-11-02 10:00:00.000100)  can0", 1)
         .replace("\n  can0", "\n (2026-11-02 10:00:00.010100)  can0  TX B -"), "can0"),
        ("a.trc", TRC, "0"),
        ("trc.log", TRC, "0"),
        ("a.trc.gz", gzip.compress(TRC.encode(), mtime=0), "0"),
        ("asc.txt", asc("absolute", f"0.01 1 {RX}", f"0.02 1 {TX}"), "0"),
    ],
)  # fmt: skip
def test_logs_in_the_forms_of_other_tools(
    written: Callable[..., Path], name: str, text: str | bytes, channel: str
) -> None:
    path = written(name, text)
    assert find_log(path, None) == ([path], None)
    found = frames_of(path)
    assert [(where, *frame) for _, where, *frame in found] == [
        (channel, *BOOT),
        (channel, *UPLOAD),
    ]
    assert found[1][0] - found[0][0] == pytest.approx(10.0)


def test_a_log_without_times_says_so(written: Callable[..., Path]) -> None:
    note, *lines = lines_of(written("screen.log", SCREEN))
    assert "no times" in note
    assert [line.split()[2] for line in lines] == ["703", "603"]


def test_times_between_frames_are_refused(written: Callable[..., Path]) -> None:
    """candump -t d: who knows on what interface the frame before was?"""
    times = ("000.000000", "000.010000", "000.000200", "000.010000", "000.000100")
    text = "".join(f" ({time})  can0  703   [1]  00\n" for time in times)
    with pytest.raises(UserError, match="candump -t d"):
        frames_of(written("some.log", text))
    from_begin = "".join(f" (000.0{n}0000)  can0  703   [1]  00\n" for n in range(5))
    assert len(frames_of(written("zero.log", from_begin))) == 5


def test_remote_extended_and_error_frames_of_the_screen(written: Callable[..., Path]) -> None:
    text = (
        "  can0  703   [1]  remote request\n  can1  12345678   [2]  01 02   '..'\n"
        "  can0  20000088   [8]  00 00 08 00 00 00 00 00   ERRORFRAME\n"
    )
    remote, extended, error = messages_of([written("some.log", text)])
    assert (remote.is_remote_frame, remote.dlc) == (True, 1)
    assert (extended.is_extended_id, extended.arbitration_id) == (True, 0x12345678)
    assert bytes(extended.data) == b"\1\2"
    assert (error.is_error_frame, error.channel) == (True, "can0")


@pytest.mark.parametrize(
    ("name", "text", "line", "message"),
    [
        ("a.log", CANDUMP + "(1760500000.02", 3, "the last line is cut"),
        ("a.log", CANDUMP + "rubbish\n" + CANDUMP, 3, "the log is damaged"),
        ("a.asc", asc("absolute", f"0.01 1 {RX}", "0.02 1 6Y3 Rx d 1 00"), 5, "damaged"),
        ("a.txt", SCREEN + "  can0  603   [8]  40 00\n", 3, "2 bytes, the line says 8"),
    ],
)
def test_a_damaged_line_is_named(
    written: Callable[..., Path], name: str, text: str, line: int, message: str
) -> None:
    path = written(name, text)
    with pytest.raises(UserError, match=message) as error:
        list(messages_of([path]))
    assert (error.value.file, error.value.line) == (str(path), line)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.log", "(0.010) can0 701#00\n(0.060) can0 702#00\n(0.050) can0 703#00\nrubbish\n"),
        ("a.asc", asc("absolute", "0.010 1 701 Rx d 1 00", "0.060 1 702 Rx d 1 00",
                      "0.050 1 703 Rx d 1 00", "0.02 1 6Y3 Rx d 1 00")),
        ("a.trc", ";$FILEVERSION=1.1\n     1)       10.0  Rx         0701  1  00\n"
         "     2)       60.0  Rx         0702  1  00\n     3)       50.0  Rx         0703  1  00\n"
         "     4)       70.0  Rx         0704  9  00\n"),
    ],
)  # fmt: skip
def test_what_came_before_a_damage_is_there_in_its_order(
    written: Callable[..., Path], name: str, text: str
) -> None:
    """Three frames at 10, 60 and 50 ms: the second of them was written too early."""
    shown = []
    with pytest.raises(UserError):  # noqa: PT012 - one line after the other, until it raises
        for line in tell_log([written(name, text)], None, Selection(is_all=True)):
            shown.append(line.split()[2])
    assert shown == ["701", "703", "702"]


def pcapng(
    link: int, packets: list[tuple[int, bytes]], order: str = "<", resolution: int | None = None
) -> bytes:
    """Return a pcapng file of one interface; packets: ticks, data."""
    options = {} if resolution is None else {RESOLUTION: bytes([resolution])}
    head = section(order) + interface(link, options, order)
    return head + b"".join(packet(ticks, data, 0, order) for ticks, data in packets)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    ("resolution", "per_ms"), [(None, 1000), (9, 1_000_000), (3, 1), (0x80 | 10, 1.024)]
)
def test_pcapng_of_any_tool(
    written: Callable[..., Path], order: str, resolution: int | None, per_ms: float
) -> None:
    """Microseconds where the file says nothing; powers of ten and of two; both orders of bytes."""
    frame = struct.pack(">IB3x8s", 0x703, 1, b"\0")
    data = pcapng(227, [(round(1000 * per_ms), frame)], order, resolution)
    assert frames_of(written("some.pcapng", data)) == [(1000.0, "", *BOOT)]
    packed = frames_of(written("some.pcapng.gz", gzip.compress(data)))
    assert packed == [(1000.0, "", *BOOT)]


def test_pcapng_of_another_link_is_refused(written: Callable[..., Path]) -> None:
    with pytest.raises(UserError, match="another link type"):
        lines_of(written("some.pcapng", pcapng(113, [(0, bytes(16))])))


def test_a_pcap_that_is_packed_is_read(written: Callable[..., Path]) -> None:
    head = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 16, 227)
    record = struct.pack("<IIII", 0, 5_000_000, 16, 16) + struct.pack(">IB3x8s", 0x703, 1, b"\0")
    path = written("some@can2.pcap.gz", gzip.compress(head + record))
    assert frames_of(path) == [(5.0, "can2", *BOOT)]


def at(*times_ms: float) -> Iterator[can.Message]:
    """Make messages whose identifiers are their places."""
    for number, time_ms in enumerate(times_ms):
        yield can.Message(timestamp=time_ms / 1e3, arbitration_id=number, is_extended_id=False)


def test_frames_that_were_written_late_come_in_their_places() -> None:
    ordered = [message.arbitration_id for message in in_order(at(10, 60, 50, 60, 70, 55))]
    assert ordered == [0, 2, 5, 1, 3, 4]


def test_a_log_whose_time_begins_anew_keeps_the_order_of_its_file(
    written: Callable[..., Path],
) -> None:
    """Two recordings in one file are not mixed."""
    times = (5.0, 7.0, 5.5, 6.0, 7.5)
    ordered = [m.arbitration_id for m in in_order(at(*(1e3 * time for time in times)))]
    assert ordered == [0, 1, 2, 3, 4]
    text = "".join(f"({time:.6f}) can0 703#00\n" for time in times)
    lines = lines_of(written("twice.log", text))
    assert lines[2] == "the times of the log go back by 1500.000 ms here"
    assert len(lines_of(written("twice.log", text), to_ms=6e3)) == 4
    # Each of them is by time
    ordered = [m.arbitration_id for m in in_order(at(5e3, 5.9e3, 5.8e3, 1e3, 1.9e3, 1.2e3, 1.5e3))]
    assert ordered == [0, 2, 1, 3, 5, 6, 4]


def test_a_blf_that_is_not_by_time_shows_all_until_the_end(tmp_path: Path) -> None:
    path = tmp_path / "unsorted.blf"
    with can.BLFWriter(path) as writer:
        for message in at(10, 60, 50):
            writer.on_message_received(message)
    shown = [line.split()[2] for line in lines_of(path, to_ms=45.0)]
    assert shown == ["000", "002"]  # times of this writer count from the first frame


RIG = "probe-z.toml"


@pytest.mark.parametrize("channel", ["can0", "vcan7"])
def test_the_only_channel_of_a_log_is_the_only_segment_of_a_rig(
    written: Callable[..., Path], channel: str
) -> None:
    text = CANDUMP.replace("can0", channel)
    note, first, _ = lines_of(written("some.log", text), settings_of(RIGS / RIG, []))
    assert note == f"channel {channel} of the log is taken for segment can1"
    assert first.split()[1:4] == ["can1", "703", "Z.heartbeat"]


def test_of_several_channels_none_is_guessed(written: Callable[..., Path]) -> None:
    path = written("some.log", CANDUMP + CANDUMP.replace("can0", "can3"))
    settings = settings_of(RIGS / RIG, [])
    lines = lines_of(path, settings)
    assert sum("is no segment of the rig (can1)" in line for line in lines) == 2
    assert not any("Z." in line for line in lines)
    lines = lines_of(path, settings, segments={"can3": "can1"})
    assert [line.split()[1] for line in lines if "heartbeat" in line] == ["can0", "can1"]
    assert sum("Z.heartbeat" in line for line in lines) == 1


def test_channels_as_the_user_says_them(written: Callable[..., Path]) -> None:
    assert given_channels(["can0=can1", " 1 = can2 "]) == {"can0": "can1", "1": "can2"}
    for words in (["can0"], ["=can1"], ["can0="], ["a=b", "a=c"]):
        with pytest.raises(UserError, match="--segment"):
            given_channels(words)
    with pytest.raises(UserError, match="no segment of the rig"):
        Channels(["can1"], {"can0": "can2"}, set)
    renamed = lines_of(written("some.log", CANDUMP), segments={"can0": "x", "can9": "y"})
    assert [line.split()[1] for line in renamed[:2]] == ["x", "x"]
    assert "no frame of channel can9" in renamed[2]


EDS_OBJECTS = """[ManufacturerObjects]
SupportedObjects=2
1=0x3001
2=0x3002

[3001]
ParameterName=Motor data
ObjectType=0x9
SubNumber=2

[3001sub0]
ParameterName=Highest sub-index
ObjectType=0x7
DataType=0x0005
AccessType=ro
DefaultValue=1
PDOMapping=0

[3001sub1]
ParameterName=Current
ObjectType=0x7
DataType=0x0003
AccessType=rw
PDOMapping=0

[3002]
ParameterName=Temperature
ObjectType=0x7
DataType=0x0003
AccessType=rw
PDOMapping=0
"""


def test_objects_of_the_maker_have_the_names_and_signs_of_its_eds(
    written: Callable[..., Path], tmp_path: Path
) -> None:
    eds = written("some.eds", f"[FileInfo]\nFileName=some.eds\n\n{EDS_OBJECTS}")
    rig = (RIGS / RIG).read_text(encoding="utf-8")
    rig = rig.replace("[drive.servo]", f'[drive.servo]\neds = "{eds.name}"')
    path = written("rig.toml", rig.replace('"lists/', f'"{RIGS}/lists/'))
    text = (
        "(0.001) can1 603#4001300100000000\n(0.002) can1 583#4B013001FEFF0000\n"
        "(0.003) can1 603#4002300000000000\n(0.004) can1 583#4B023000FEFF0000\n"
        "(0.005) can1 603#4003300000000000\n"
    )
    settings = settings_of(path, [])
    shown = [line.split("load ")[1] for line in lines_of(written("some.log", text), settings)]
    assert shown == [
        "0x3001:1 Motor data, Current",
        "0x3001:1 Motor data, Current = -2 (0xFFFE)",
        "0x3002:0 Temperature",
        "0x3002:0 Temperature = -2 (0xFFFE)",
        "0x3003:0",
    ]


class Standing:
    """A reader that has read something and then never comes back."""

    place = (3, 4096)


def test_a_reader_that_stands_still_ends_with_the_name_of_the_file() -> None:
    path = Path("odd.blf")
    with (
        pytest.raises(UserError, match=r"stands still, 3 frames and 4096 bytes") as error,
        needs_progress(Standing(), path, cpu_s=0.02),
    ):
        for _ in count():
            pass
    assert error.value.file == str(path)


def test_a_reader_that_goes_on_is_left_alone(tmp_path: Path) -> None:
    progress = Progress()
    with needs_progress(progress, tmp_path, cpu_s=0.005):
        for _ in range(200_000):
            progress.frames += 1


def test_our_own_asc_log_is_read_as_before(tmp_path: Path) -> None:
    path = tmp_path / "own.asc"
    writer = asc_writer(path)
    for message in at(1, 2.5):
        writer.on_message_received(message)
    writer.stop()
    assert [time_ms for time_ms, *_ in frames_of(path)] == [1.0, 2.5]
