"""What candump shows on the screen: times, identifiers, remote frames, times between frames."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from axisrig.bench.tools.bus_log.reading.candump import read_screen
from axisrig.bench.tools.bus_log.reading.lines import Lines
from axisrig.bench.tools.bus_log.reading.progress import Progress
from axisrig.kernel.errors import UserError


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


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("  can0  703   [3]  01 02", "^2 bytes, the line says 3$"),
        ("  can0  703   3  01 02 03", "^no line of candump$"),
    ],
)
def test_a_damaged_line_is_refused(line: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=words):
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
