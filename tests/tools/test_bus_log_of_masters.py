"""`axisrig bus` over logs of masters of any make: block transfers, own mappings, error frames.

Frames are written by CiA 301 (SDO block transfer, PDO parameters), not by our own server.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

import pytest

from axisrig.bench.bus.can.dissect import dissect
from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.bus_log import tell_log
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers, Value
from axisrig.bench.tools.bus_log.choice.selection import Selection

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
Sdo = tuple[str, bytes]
"""Side, "request" or "answer", and the eight bytes."""


@pytest.fixture
def outcome(tmp_path: Path) -> "Tell":
    return Tell(tmp_path)


class Tell:
    """Writes frames `id#data`, one each ms, as a candump log of can1, and has them told."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "some.log"

    def __call__(
        self, frames: Sequence[str], settings: Settings | None = None, **words: object
    ) -> list[str]:
        lines = [f"({n / 1e3:.6f}) can1 {frame} R\n" for n, frame in enumerate(frames, 1)]
        return self.text("".join(lines), settings, **words)

    def text(self, text: str, settings: Settings | None = None, **words: object) -> list[str]:
        self.path.write_text(text, encoding="utf-8")
        selection = Selection(**{"is_all": True, **words})  # type: ignore[arg-type]
        return [*tell_log([self.path], settings, selection)]


@pytest.fixture(scope="module")
def rig() -> Settings:
    """Axis Z is node 3 on can1; 1048576 units are 10 mm."""
    return settings_of(RIGS / "probe-z.toml", [])


# Block transfers


def block(data: bytes, size: int, taken: Iterator[int]) -> Iterator[tuple[bool, bytes]]:
    """Yield the frames of data in blocks: (of the side that has them, bytes).

    taken: how many of `count` segments of a block come over, as share in per mille.
    """
    segments = [data[at : at + 7] for at in range(0, len(data), 7)]
    at = 0
    while at < len(segments):
        part = segments[at : at + size]
        for number, segment in enumerate(part, 1):
            is_last = at + number == len(segments)
            yield True, bytes([number | is_last << 7]) + segment.ljust(7, b"\xee")
        count = max(1, len(part) * next(taken) // 1000)
        at += count
        yield False, bytes([2, count, size, 0, 0, 0, 0, 0])


def download(place: bytes, data: bytes, size: int, taken: Iterator[int]) -> Iterator[Sdo]:
    yield "request", b"\xc6" + place + len(data).to_bytes(4, "little")
    yield "answer", b"\xa4" + place + bytes([size, 0, 0, 0])
    for is_sender, frame in block(data, size, taken):
        first = frame[0] if is_sender else 0xA0 | frame[0]
        yield ("request" if is_sender else "answer"), bytes([first]) + frame[1:]
    yield "request", bytes([0xC1 | (-len(data) % 7) << 2, 0x34, 0x12]) + bytes(5)
    yield "answer", b"\xa1" + bytes(7)


def upload(place: bytes, data: bytes, size: int, taken: Iterator[int]) -> Iterator[Sdo]:
    yield "request", b"\xa4" + place + bytes([size, 0, 0, 0])
    yield "answer", b"\xc6" + place + len(data).to_bytes(4, "little")
    yield "request", b"\xa3" + bytes(7)
    for is_sender, frame in block(data, size, taken):
        first = frame[0] if is_sender else 0xA0 | frame[0]
        yield ("answer" if is_sender else "request"), bytes([first]) + frame[1:]
    yield "answer", bytes([0xC1 | (-len(data) % 7) << 2, 0x34, 0x12]) + bytes(5)
    yield "request", b"\xa1" + bytes(7)


def ids(frames: Iterator[Sdo] | Sequence[Sdo], node: int = 3) -> list[str]:
    base = {"request": 0x600, "answer": 0x580}
    return [f"{base[side] + node:03X}#{data.hex().upper()}" for side, data in frames]


def whole() -> Iterator[int]:
    while True:
        yield 1000


@pytest.mark.parametrize("transfer", [download, upload])
@pytest.mark.parametrize("size", [1, 65, 127])
def test_segments_of_a_block_are_data_whatever_their_first_byte_is(
    outcome: Tell, size: int, transfer: object
) -> None:
    """130 segments: among their numbers are those of every command, with the last bit too."""
    data = bytes(range(256)) * 4
    for length in (1, 7 * 65, 910):  # the last number is 1, 65 (0xC1, an end of a block), 3
        frames = ids(transfer(bytes.fromhex("101000"), data[:length], size, whole()))  # type: ignore[operator]
        lines = outcome(frames)
        segments = [line for line in lines if ", segment " in line]
        assert not [line for line in lines if "abort" in line or "unknown" in line]
        assert len(segments) == -(-length // 7)
        assert [", the last one" in line for line in segments] == [False] * (len(segments) - 1) + [
            True
        ]
        assert all("0x1010:0" in line for line in segments)
        assert outcome(frames, only=("abort",))[0].startswith("no frame for abort")
        found = outcome(frames, only=("1010:0",))
        assert len(found) == len(segments) + 2  # and both frames of the begin


def test_values_that_come_in_blocks_are_put_together() -> None:
    """Any length, any size of blocks, segments that have to be sent again, two channels at once."""
    chosen = Random(5)
    for _ in range(60):
        streams = []
        for node in (3, 4):
            data = chosen.randbytes(chosen.randint(1, 400))
            transfer = chosen.choice((download, upload))
            taken = iter(lambda: chosen.choice((0, 300, 900, 1000, 1000)), None)
            frames = transfer(b"\x08\x10\x02", data, chosen.randint(1, 127), taken)
            streams.append((node, data, list(frames)))
        transfers, values = Transfers(), []
        while any(frames for _, _, frames in streams):
            node, _, frames = chosen.choice([stream for stream in streams if stream[2]])
            side, data = frames.pop(0)
            base = 0x600 if side == "request" else 0x580
            seen = dissect(data_frame(base + node, data))
            _, value = transfers.take("can1", data, seen)
            values += [(node, value)] if value is not None else []
        wanted = [(node, Value(0x1008, 2, data)) for node, data, _ in streams]
        assert sorted(values, key=lambda found: found[0]) == wanted


@pytest.mark.parametrize("side", ["request", "answer"])
@pytest.mark.parametrize("after", range(2, 9))
def test_an_abort_of_either_side_ends_a_block(outcome: Tell, side: str, after: int) -> None:
    frames = [*download(bytes.fromhex("101000"), bytes(40), 3, whole())][:after]
    abort = (side, bytes.fromhex("8010100000000405"))  # 0504 0000: timed out
    upload_of_one = ("request", bytes.fromhex("4041600000000000"))
    lines = outcome(ids([*frames, abort, upload_of_one]))
    assert "abort 0x1010:0" in lines[-2]
    assert "0x05040000" in lines[-2]
    assert lines[-1].endswith("upload 0x6041:0 Statusword")


def test_a_block_that_began_before_the_log_is_no_abort(outcome: Tell) -> None:
    """The other bits of the first byte of an abort are 0."""
    frames = [*download(bytes.fromhex("101000"), bytes(21), 127, whole())][3:]
    lines = outcome(ids(frames))
    assert not [line for line in lines if "abort" in line]
    assert outcome(ids([("answer", bytes.fromhex("8010100000000405"))]), only=("abort",))


def test_a_master_that_begins_anew_within_a_block_is_understood(outcome: Tell) -> None:
    frames = [*download(bytes.fromhex("101000"), bytes(70), 127, whole())][:5]
    again = [("request", bytes.fromhex("4041600000000000"))]
    assert outcome(ids([*frames, *again]))[-1].endswith("upload 0x6041:0 Statusword")


def test_a_node_that_starts_anew_has_lost_its_block(outcome: Tell) -> None:
    frames = ids([*download(bytes.fromhex("101000"), bytes(70), 127, whole())][:5])
    assert ", segment 3: " in outcome(frames)[-1]
    *_, started, last = outcome([*frames[:-1], "703#00", frames[-1]])
    assert started.endswith("boot-up")
    assert "segment 3" not in last
    other = outcome([*frames[:-1], "704#00", frames[-1]])  # of another node
    assert ", segment 3: " in other[-1]


# Mappings


def write(index: int, sub: int, value: int, size: int = 4, *, answer: str = "60") -> list[str]:
    place = index.to_bytes(2, "little").hex().upper() + f"{sub:02X}"
    head = {1: "2F", 2: "2B", 4: "23"}[size]
    data = value.to_bytes(4, "little").hex().upper()
    tail = "00000000" if answer == "60" else "30000906"
    return [f"603#{head}{place}{data}"] + ([f"583#{answer}{place}{tail}"] if answer else [])


def read(index: int, sub: int, value: int) -> list[str]:
    place = index.to_bytes(2, "little").hex().upper() + f"{sub:02X}"
    return [f"603#40{place}00000000", f"583#43{place}" + value.to_bytes(4, "little").hex().upper()]


def mapped(pdo: int, cob_id: int, *entries: int) -> list[str]:
    """A PDO as CiA 301 wants it written: off, emptied, entries, their number, on."""
    frames = write(pdo, 1, cob_id | 1 << 31) + write(pdo + 0x200, 0, 0, 1)
    for place, entry in enumerate(entries, 1):
        frames += write(pdo + 0x200, place, entry)
    return frames + write(pdo + 0x200, 0, len(entries), 1) + write(pdo, 1, cob_id)


TORQUE, ACTUAL, SPEED, STATUS = 0x60770010, 0x60640020, 0x606C0020, 0x60410010
PDO = "183#370683FF0000A000"  # 0x0637, -125, 10485760 = 100 mm; or the default: 6041, 6064, 60B9


@pytest.mark.parametrize("with_rig", [True, False])
def test_a_mapping_of_the_log_says_what_its_pdos_carry(
    outcome: Tell, rig: Settings, with_rig: bool
) -> None:
    frames = [*mapped(0x1800, 0x183, STATUS, TORQUE, ACTUAL), PDO]
    (line,) = outcome(frames, rig if with_rig else None, only=("TPDO",))
    assert line.split()[3] == ("Z.TPDO1" if with_rig else "3.TPDO1")
    assert "Statusword 0x0637 (operation enabled), Torque actual value -125" in line
    assert line.endswith("Position actual value 10485760" + " (100.000000 mm)" * with_rig)


def test_identifiers_of_the_log_say_which_pdo_a_frame_is(outcome: Tell, rig: Settings) -> None:
    """TPDO2 on 0x1A3, in the pre-defined set TPDO1 of node 35; TPDO5 on 0x2F0; 29 bits; RPDO1."""
    frames = [
        *mapped(0x1801, 0x1A3, SPEED), "1A3#9A990100",
        *mapped(0x1804, 0x2F0, TORQUE), "2F0#83FF",
        *mapped(0x1803, 0x18FF0003 | 1 << 29, TORQUE), "18FF0003#0100",
        *mapped(0x1400, 0x2F1, 0x60400010), "2F1#0F00", "203#0F00000000000000",
    ]  # fmt: skip
    lines = outcome(frames, rig, only=("PDO",))
    assert [line.split(maxsplit=4)[3:] for line in lines] == [
        ["Z.TPDO2", "Velocity actual value 104858"],
        ["Z.TPDO5", "Torque actual value -125"],
        ["Z.TPDO4", "Torque actual value 1"],
        ["Z.RPDO1", "Controlword 0x000F (enable operation)"],
        ["Z.RPDO1", "0f 00 00 00 00 00 00 00"],  # by its identifier alone: nothing says more
    ]
    assert (
        len(outcome(frames, rig, only=("Z.TPDO5",)))
        == len(outcome(frames, rig, only=("tpdo5",)))
        == 1
    )


def test_frames_of_a_pdo_that_was_switched_off_are_not_taken_for_it(
    outcome: Tell, rig: Settings
) -> None:
    """On, off, on: the rig's latch in TPDO2, no TPDO2, and again."""
    frame = "283#9A9901000100"
    frames = [frame, *write(0x1801, 1, 0x80000283), frame, *write(0x1801, 1, 0x283), frame]
    lines = outcome(frames, rig, only=("TPDO2",))
    assert ["Touch probe" in line for line in lines] == [True, False, True]


@pytest.mark.parametrize("answer", ["80", ""])
def test_a_write_that_was_refused_or_not_answered_counts_for_nothing(
    outcome: Tell, rig: Settings, answer: str
) -> None:
    frames = [*write(0x1801, 1, 0x1A3, answer=answer), "1A3#9A990100", "283#9A990100"]
    assert [line.split()[3] for line in outcome(frames, rig, only=("PDO",))] == [
        "35.TPDO1", "Z.TPDO2",
    ]  # fmt: skip


def test_a_mapping_that_was_read_counts_too(outcome: Tell) -> None:
    frames = [*read(0x1801, 1, 0x400001A3), *read(0x1A01, 0, 1), *read(0x1A01, 1, SPEED)]
    line = outcome([*frames, "1A3#9A990100"])[-1]
    assert line.split(maxsplit=4)[3:] == ["3.TPDO2", "Velocity actual value 104858"]


def test_of_a_mapping_that_is_known_in_part_nothing_is_guessed(
    outcome: Tell, rig: Settings
) -> None:
    """Two entries of three were before the log: bytes without a rig, with one its entries."""
    frames = [*write(0x1A00, 2, TORQUE), *write(0x1A00, 0, 3, 1), "183#370683FF0100"]
    assert outcome(frames)[-1].endswith("3.TPDO1          37 06 83 ff 01 00")
    assert "Torque actual value -125" in outcome(frames, rig)[-1]


def test_a_node_that_starts_anew_has_what_the_rig_says(outcome: Tell, rig: Settings) -> None:
    frames = [*mapped(0x1800, 0x183, STATUS, TORQUE, ACTUAL), PDO, "703#00", PDO]
    own, after = outcome(frames, rig, only=("TPDO",))
    assert ("Torque" in own, "Touch probe status" in own) == (True, False)
    assert ("Torque" in after, "Touch probe status" in after) == (False, True)


def test_what_was_written_before_the_time_that_is_shown_counts(outcome: Tell) -> None:
    frames = [*mapped(0x1801, 0x1A3, SPEED), "1A3#9A990100"]
    (line,) = outcome(frames, from_ms=len(frames) - 0.5)
    assert line.endswith("Velocity actual value 104858")


def test_nodes_and_segments_are_kept_apart(outcome: Tell) -> None:
    """Node 3 of can2 and node 4 of can1 have not been written to."""
    text = "".join(
        f"({n}.000000) can1 {frame}\n" for n, frame in enumerate(mapped(0x1800, 0x183, SPEED))
    )
    text += "".join(
        f"(90.000000) {where}#9A990100\n" for where in ("can1 183", "can2 183", "can1 184")
    )
    lines = outcome.text(text, only=("TPDO1",))
    assert ["Velocity" in line for line in lines] == [True, False, False]


# Error frames


def test_error_frames_of_candump_keep_their_segment(outcome: Tell) -> None:
    """Whatever their class: bus error, controller, no acknowledge, bus off."""
    where = ("can2 20000080", "can1 20000080", "can1 20000004", "can1 20000020", "7 20000040")
    text = "".join(f"(0.00{n}000) {what}#0000\n" for n, what in enumerate(where, 1))
    assert [line.split() for line in outcome.text(text)] == [
        ["1.000", "can2", "error", "frame"],
        ["2.000", "can1", "error", "frame", "3", "times", "until", "4.000", "ms"],
        ["5.000", "7", "error", "frame"],
    ]
