"""Rows of `axisrig bus`: what an error frame is, what is news, several files, words that ask."""

from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.bus.can.logs import open_log
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.bus_log import find_log, tell_log
from axisrig.bench.tools.bus_log.canopen.bus_words import Names
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import messages_of
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"


@pytest.fixture(scope="module")
def rig() -> Settings:
    """Axis Z is node 3 on can1."""
    return settings_of(RIGS / "probe-z.toml", [])


def shown(path: Path, *frames: can.Message, **words: object) -> list[str]:
    """Write a BLF log of these frames; return the identifiers and names that are shown."""
    with can.BLFWriter(path) as writer:
        for message in frames:
            writer.on_message_received(message)
    lines = tell_log([path], None, Selection(**words))  # type: ignore[arg-type]
    return [" ".join(line.split()[2:4]) for line in lines]


def message(
    at_ms: float, can_id: int, data: str = "", *, is_error: bool = False, is_extended: bool = False
) -> can.Message:
    return can.Message(
        timestamp=1 + at_ms / 1e3, arbitration_id=can_id, is_extended_id=is_extended, channel=0,
        is_error_frame=is_error, data=bytes.fromhex(data),
    )  # fmt: skip


@pytest.mark.parametrize("can_id", [0x183, 0x703, 0x603])
def test_an_error_frame_is_none_of_the_frame_that_it_has_destroyed(
    rig: Settings, can_id: int
) -> None:
    names, frame = Names(rig), data_frame(can_id, b"")
    found = names.follow("can1", frame, dissect(frame, is_error=True))
    assert (found.service, found.node) == ("error frame", None)
    described = names.describe("can1", frame, found)
    assert (described.name, described.text) == ("error frame", "")
    assert described.tags == {"error frame", "error"}


@pytest.mark.parametrize("length", [0, 1, 5, 7, 8])
def test_a_pdo_of_another_length_than_its_mapping_is_shown_as_it_is(
    rig: Settings, length: int
) -> None:
    """TPDO2 of Z has 6 bytes in the mapping of the kernel: fewer and more are no values."""
    names, data = Names(rig), bytes(range(1, length + 1))
    for is_whole in (False, True):
        sent = bytes(6) if is_whole else data
        frame = data_frame(0x283, sent)
        described = names.describe("can1", frame, names.follow("can1", frame, dissect(frame)))
        assert described.name == "Z.TPDO2"
        is_raw = described.text == f"{sent.hex(' ')} ({len(sent)} bytes, 6 are mapped)"
        assert is_raw is not is_whole


def test_an_error_frame_makes_no_news_of_a_telegram_that_says_the_same(tmp_path: Path) -> None:
    frames = (
        message(0, 0x183, "0100"), message(1, 0x183, is_error=True), message(2, 0x183, "0100"),
        message(3, 0x183, "0200"), message(4, 0x183, "0200"), message(5, 0x183, "0100"),
    )  # fmt: skip
    found = shown(tmp_path / "x.blf", *frames)
    assert [row.split()[0] for row in found] == ["183", "error", "183", "183"]


def test_an_identifier_of_29_bits_has_eight_digits_and_is_none_of_11_bits(tmp_path: Path) -> None:
    """A PDO that repeats stays old when the same number comes in 29 bits in between."""
    frames = (
        message(0, 0x183, "0100"), message(1, 0x183, "0200", is_extended=True),
        message(2, 0x183, "0100"), message(3, 0x1ABCDEF0, is_extended=True),
        message(4, 0x7E, "01"),
    )  # fmt: skip
    found = [row.split()[0] for row in shown(tmp_path / "x.blf", *frames)]
    assert found == ["183", "00000183", "1ABCDEF0", "07E"]


def test_each_boot_up_is_shown_and_a_heartbeat_when_its_state_changes(tmp_path: Path) -> None:
    """A toggle bit is no change of the state."""
    states = ("00", "00", "7f", "7f", "ff", "05", "05", "00", "05")
    frames = [message(n, 0x703, state) for n, state in enumerate(states)]
    assert len(shown(tmp_path / "x.blf", *frames)) == 6
    assert len(shown(tmp_path / "y.blf", *frames, is_all=True)) == len(states)


@pytest.mark.parametrize(
    ("word", "is_shown"),
    [("1018:4", True), ("1018:04", True), ("0x1018:04", True), ("1018", True), ("1018:3", False),
     ("1018:14", False), ("1019:4", False)],
)  # fmt: skip
def test_an_object_is_asked_for_with_or_without_zeros(
    tmp_path: Path, word: str, is_shown: bool
) -> None:
    frames = [message(0, 0x603, "4018100400000000")]
    found = shown(tmp_path / "x.blf", *frames, only=(word,))
    assert (found == ["603 3.SDO"]) is is_shown


def test_pcap_logs_of_several_segments_are_one_log_by_time(tmp_path: Path) -> None:
    log = open_log(tmp_path / "run.pcap", ["can1", "can2"])
    for at_ms, segment, can_id in ((0, "can2", 1), (1, "can1", 2), (2, "can1", 3), (3, "can2", 4)):
        log(at_ms * MS, segment, data_frame(can_id, b""), False)
    log.stop()
    paths = [tmp_path / f"run@{segment}.pcap" for segment in ("can1", "can2")]
    for order in (paths, paths[::-1]):
        found = [(m.channel, m.arbitration_id) for m in messages_of(order)]
        assert found == [("can2", 1), ("can1", 2), ("can1", 3), ("can2", 4)]


def test_a_run_that_is_named_is_not_the_log_of_the_drives_of_a_folder(tmp_path: Path) -> None:
    (tmp_path / "bus.blf").write_bytes(b"")
    assert find_log(tmp_path, None) == ([tmp_path / "bus.blf"], None)
    with pytest.raises(UserError, match="no results folder"):
        find_log(tmp_path, "row-1")
