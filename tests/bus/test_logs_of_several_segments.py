"""Logs of several segments: segment n is channel n, in the order of the rig, in every kind of log.

docs/campaigns.md; python-can counts the channels that it reads from 0.
"""

import struct
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.logs import BusLog, open_log
from axisrig.bench.bus.journal import Entry
from axisrig.kernel.time.clock import MS, S

SEGMENTS = ("first", "second", "third")
ORDERS = (SEGMENTS, ("third", "first", "second"), ("second",))


def entries(names: tuple[str, ...], *, with_errors: bool = True) -> list[Entry]:
    """Frames of each segment in turn, the first with the identifier 101, and an error of each."""
    found: list[Entry] = []
    for number, name in enumerate([*names, *reversed(names)]):
        can_id = 0x101 + names.index(name)
        frame = Frame(can_id, bytes((number,)), False, False, 1)
        found.append((2 * S + number * MS, name, frame, False))
        if with_errors and number < len(names):
            found.append((2 * S + number * MS + MS // 2, name, frame, True))
    return found


def write(log: BusLog, rows: list[Entry], *, in_blocks: bool) -> None:
    if in_blocks:
        log.take(rows[:3])
        log.take(rows[3:])
    else:
        for row in rows:
            log(*row)
    log.stop()


@pytest.mark.parametrize("in_blocks", [True, False])
@pytest.mark.parametrize("kind", ["blf", "asc"])
@pytest.mark.parametrize("names", ORDERS)
def test_channels_of_a_log_are_numbered_in_the_order_of_the_segments(
    tmp_path: Path, names: tuple[str, ...], kind: str, in_blocks: bool
) -> None:
    path, rows = tmp_path / f"bus.{kind}", entries(names)
    if in_blocks and len(rows) <= 3:
        rows += entries(names)
    write(open_log(path, names), rows, in_blocks=in_blocks)
    with can.LogReader(path) as reader:
        read = list(reader)
    found = [(one.channel, one.is_error_frame) for one in read]
    assert found == [(names.index(name), is_error) for _, name, _, is_error in rows]
    for one, (_, name, frame, is_error) in zip(read, rows, strict=True):
        if not is_error:
            assert one.arbitration_id == 0x101 + names.index(name)
            assert bytes(one.data) == frame.data


@pytest.mark.parametrize("names", ORDERS)
def test_the_first_segment_is_channel_1_in_the_text_of_a_log(
    tmp_path: Path, names: tuple[str, ...]
) -> None:
    path, rows = tmp_path / "bus.asc", entries(names, with_errors=False)
    write(open_log(path, names), rows, in_blocks=False)
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    found = [(words[1], words[2]) for words in lines if len(words) > 5 and words[2][0] == "1"]
    channels = [names.index(name) + 1 for _, name, _, _ in rows]
    assert found == [(str(channel), str(100 + channel)) for channel in channels]


@pytest.mark.parametrize("names", ORDERS)
def test_a_candump_has_the_name_of_each_segment(tmp_path: Path, names: tuple[str, ...]) -> None:
    path, rows = tmp_path / "bus.log", entries(names, with_errors=False)
    write(open_log(path, names), rows, in_blocks=True)
    found = [line.split()[1:3] for line in path.read_text(encoding="utf-8").splitlines()]
    expected = [[name, f"{f.arbitration_id:03X}#{f.data.hex().upper()}"] for _, name, f, _ in rows]
    assert found == expected


@pytest.mark.parametrize("names", ORDERS)
def test_a_pcap_is_a_file_for_each_segment_with_its_own_frames(
    tmp_path: Path, names: tuple[str, ...]
) -> None:
    """One segment alone keeps the name of the file; 24 bytes of head, 32 of each frame."""
    rows = entries(names)
    write(open_log(tmp_path / "bus.pcap", names), rows, in_blocks=True)
    several = {name: tmp_path / f"bus@{name}.pcap" for name in names}
    paths = several if len(names) > 1 else {names[0]: tmp_path / "bus.pcap"}
    assert sorted(tmp_path.iterdir()) == sorted(paths.values())
    for name, path in paths.items():
        content = path.read_bytes()[24:]
        own = [row for row in rows if row[1] == name]
        assert len(content) == 32 * len(own)
        for at, (time_ns, _, frame, is_error) in zip(range(0, len(content), 32), own, strict=True):
            seconds, rest_ns = struct.unpack_from("<II", content, at)
            (can_id,) = struct.unpack_from(">I", content, at + 16)
            assert seconds * S + rest_ns == time_ns
            assert can_id == ((1 << 29 | 8) if is_error else frame.arbitration_id)


@pytest.mark.parametrize("suffix", ["BLF", "LOG", "ASC", "PCAP", "Blf"])
@pytest.mark.parametrize("names", ORDERS[1:])
def test_the_suffix_of_a_log_may_be_in_capitals(
    tmp_path: Path, names: tuple[str, ...], suffix: str
) -> None:
    """A pcap of several segments gets names of its own; the others keep theirs."""
    path, rows = tmp_path / f"bus.{suffix}", entries(names, with_errors=False)
    write(open_log(path, names), rows, in_blocks=False)
    if suffix == "PCAP":
        wanted = [tmp_path / f"bus@{name}.pcap" for name in names]
        wanted = wanted if len(names) > 1 else [path]
        assert sorted(tmp_path.iterdir()) == sorted(wanted)
        assert sum(len(each.read_bytes()) - 24 for each in wanted) == 32 * len(rows)
        return
    plain = path.rename(path.with_suffix(f".{suffix.lower()}"))
    with can.LogReader(plain) as reader:
        read = [(one.arbitration_id, bytes(one.data)) for one in reader]
    assert read == [(frame.arbitration_id, frame.data) for _, _, frame, _ in rows]


@pytest.mark.parametrize("in_blocks", [True, False])
@pytest.mark.parametrize("with_errors", [True, False])
def test_a_blf_says_how_many_frames_it_has(
    tmp_path: Path, with_errors: bool, in_blocks: bool
) -> None:
    path, rows = tmp_path / "bus.blf", entries(SEGMENTS, with_errors=with_errors)
    write(open_log(path, SEGMENTS), rows, in_blocks=in_blocks)
    with can.BLFReader(path) as reader:
        assert reader.object_count == len(list(reader)) == len(rows)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("suffix", ["blf", "log", "asc", "pcap"])
@pytest.mark.parametrize("in_blocks", [True, False])
def test_a_log_that_cannot_be_written_names_its_file(
    tmp_path: Path, suffix: str, in_blocks: bool
) -> None:
    """Of a pcap only that of the second segment is on the full disk."""
    full = tmp_path / ("bus@second.pcap" if suffix == "pcap" else f"bus.{suffix}")
    full.symlink_to("/dev/full")
    log = open_log(tmp_path / f"bus.{suffix}", SEGMENTS)
    of_second = [row for row in entries(SEGMENTS) if row[1] == "second"]
    with pytest.raises(OSError, match="No space left") as found:
        write(log, [*entries(SEGMENTS), *of_second * 200], in_blocks=in_blocks)
    assert found.value.filename == str(full)
