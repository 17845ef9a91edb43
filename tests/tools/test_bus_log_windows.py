"""Which lines of an EtherCAT log are shown, and times of candump's screen."""

import struct
from datetime import UTC, datetime
from pathlib import Path

import pytest
from tests.tools.test_words_of_lines import FPRD, FPWR, FRMW, frame

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.ethercat.log import tell_lines
from axisrig.bench.tools.bus_log.reading.candump import read_screen
from axisrig.bench.tools.bus_log.reading.lines import Lines
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

COURSE = [(1, 2), (2, 2), (3, 4), (4, 4), (5, 8), (6, 2)]
"""ms, state of a slave: PREOP twice, SAFEOP twice, OP, PREOP again. Its time comes with each."""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "run@ec1.pcapng"
    file = PcapngFile(path, ["ec1"])
    for at_ms, state in COURSE:
        time = (FRMW, 1001, 0x0910, bytes(8), 1)
        asked = (FPWR, 1001, 0x0120, struct.pack("<H", state), 1)
        file.add(at_ms * MS, 0, frame(time, asked, (FPRD, 1002, 0x0130, bytes([state, 0]), 1)))
    file.stop()
    return path


def shown(log: Path, **words: object) -> list[tuple[int, str]]:
    """Instant and name of each line."""
    selection = Selection(**words)  # type: ignore[arg-type]
    found = [text.split() for text in tell_lines([log], None, selection)]
    return [(int(float(words[0])), words[2]) for words in found]


ASKED, STATUS, TIME = "1001.FPWR", "1002.FPRD", "1001.FRMW"


def test_a_line_is_shown_when_it_says_something_new_of_its_own_name(log: Path) -> None:
    new_ms = [1, 3, 5, 6]
    assert shown(log) == [(at_ms, name) for at_ms in new_ms for name in (ASKED, STATUS)]
    whole = [(at_ms, name) for at_ms, _ in COURSE for name in (TIME, ASKED, STATUS)]
    assert shown(log, is_all=True) == whole


@pytest.mark.parametrize(
    ("from_ms", "to_ms", "new_ms"),
    [(1.0, 1.0, [1]), (1.001, 2.999, []), (3.0, 5.0, [3, 5]), (4.0, 6.0, [5, 6]), (2.0, 4.9, [3])],
)
def test_a_window_has_both_its_ends_and_what_came_before_it_is_not_new(
    from_ms: float, to_ms: float, new_ms: list[int], log: Path
) -> None:
    found = shown(log, from_ms=from_ms, to_ms=to_ms)
    assert [at_ms for at_ms, name in found if name == STATUS] == new_ms
    every = shown(log, from_ms=from_ms, to_ms=to_ms, is_all=True)
    inside = [at_ms for at_ms, _ in COURSE if from_ms <= at_ms <= to_ms]
    assert [at_ms for at_ms, name in every if name == TIME] == inside


@pytest.mark.parametrize(
    ("only", "names"),
    [
        (("AL_STATUS",), {STATUS}), ((" al_control ",), {ASKED}),
        (("fprd", "FPWR"), {ASKED, STATUS}), ((STATUS,), {STATUS}),
        (("frmw",), set()), (("sdo",), set()),
    ],
)  # fmt: skip
def test_words_ask_for_names_commands_and_registers(
    only: tuple[str, ...], names: set[str], log: Path
) -> None:
    found = shown(log, only=only)
    assert {name for _, name in found} == names
    assert len(found) == 4 * len(names)


def test_frames_are_counted_whether_they_are_shown_or_not(log: Path) -> None:
    progress = Progress()
    assert list(tell_lines([log, log], None, Selection(to_ms=0.0), progress)) == []
    assert progress.frames == 2 * len(COURSE)


# --- candump on the screen


def screen(tmp_path: Path, *lines: str) -> Lines:
    path = tmp_path / "screen.log"
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return Lines(path, Progress())


def test_times_are_dates_seconds_or_none(tmp_path: Path) -> None:
    """A date is UTC (candump -t A), seconds have any begin; empty lines are passed over."""
    for text, time_s in (
        ("(2026-11-02 10:00:01.250000)",
         datetime(2026, 11, 2, 10, 0, 1, 250_000, UTC).timestamp()),
        ("(2024-02-29 23:59:59.999999)",
         datetime(2024, 2, 29, 23, 59, 59, 999_999, UTC).timestamp()),
        ("(1760500000.020100)", 1760500000.0201), ("(012.000300)", 12.0003), ("", 0.0),
    ):  # fmt: skip
        (one,) = read_screen(screen(tmp_path, "", f" {text}  can3  703   [1]  7F", ""))
        assert one.timestamp == pytest.approx(time_s, abs=1e-6)
        assert (one.channel, one.arbitration_id, bytes(one.data)) == ("can3", 0x703, b"\x7f")


@pytest.mark.parametrize(
    ("can_id", "is_extended", "is_error", "found"),
    [
        ("123", False, False, 0x123), ("00000123", True, False, 0x123),
        ("1FFFFFFF", True, False, 0x1FFFFFFF), ("20000004", True, True, 4),
        ("7FF", False, False, 0x7FF),
    ],
)  # fmt: skip
def test_an_identifier_of_eight_digits_is_a_long_one_or_an_error_frame(
    can_id: str, is_extended: bool, is_error: bool, found: int, tmp_path: Path
) -> None:
    """Bit 29 marks an error frame (Linux can/error.h); it is none of the identifier."""
    (one,) = read_screen(screen(tmp_path, f"  can0  {can_id}   [2]  01 02   '..'"))
    assert (one.is_extended_id, one.is_error_frame) == (is_extended, is_error)
    assert (one.arbitration_id, one.dlc, bytes(one.data)) == (found, 2, b"\1\2")


def test_a_remote_frame_has_a_length_and_no_data(tmp_path: Path) -> None:
    (one,) = read_screen(screen(tmp_path, "  can0  703   [3]  remote request"))
    assert (one.is_remote_frame, one.dlc, len(one.data)) == (True, 3, 0)
    for line in ("  can0  703   [3]  01 02", "  can0  703   3  01 02 03"):
        with pytest.raises(ValueError, match=r"2 bytes, the line says 3|no line of candump"):
            read_screen(screen(tmp_path, line))


@pytest.mark.parametrize(
    ("times_ms", "digits", "is_refused"),
    [
        ((5, 1, 2, 3), 3, False), ((5, 1, 3, 2), 3, True), ((1, 2, 3, 4), 3, False),
        ((5, 1, 3, 2), 10, False), ((5, 5, 5, 5), 3, False), ((2, 1), 3, True),
    ],
)  # fmt: skip
def test_short_times_of_which_more_than_a_quarter_go_back_are_those_between_frames(
    times_ms: tuple[int, ...], digits: int, is_refused: bool, tmp_path: Path
) -> None:
    lines = [f" ({ms / 1000:0{digits + 7}.6f})  can0  703   [1]  00" for ms in times_ms]
    if is_refused:
        with pytest.raises(UserError, match="candump -t d"):
            read_screen(screen(tmp_path, *lines))
    else:
        assert len(read_screen(screen(tmp_path, *lines))) == len(times_ms)
