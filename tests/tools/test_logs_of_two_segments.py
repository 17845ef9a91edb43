"""Frames and errors of two segments in one log: each keeps its own, whatever form the log has."""

from pathlib import Path

import pytest

from axisrig.bench.tools.bus_log.bus_log import tell_log
from axisrig.bench.tools.bus_log.choice.selection import Selection
from axisrig.bench.tools.bus_log.reading.files import messages_of

TRC = """;$FILEVERSION=2.1
;$STARTTIME=43008.920986006946
;$COLUMNS=N,O,T,B,I,d,R,L,D
"""


def lines_of(path: Path, text: str, **words: object) -> list[str]:
    path.write_text(text, encoding="utf-8")
    selection = Selection(**{"is_all": True, **words})  # type: ignore[arg-type]
    return [" ".join(line.split()) for line in tell_log([path], None, selection)]


def test_the_buses_of_a_peak_log_are_channels_from_0_on(tmp_path: Path) -> None:
    """Bus B of the file counts from 1; a line that is no frame is left out."""
    rows = [f"{n} {n}.500 DT {bus} 0703 Rx - 1 0{bus}" for n, bus in enumerate((1, 2, 3, 1), 1)]
    path = tmp_path / "some.trc"
    path.write_text(TRC + "".join(f"{row}\n" for row in rows), encoding="utf-8")
    found = [(message.channel, message.data.hex()) for message in messages_of([path])]
    assert found == [(0, "01"), (1, "02"), (2, "03"), (0, "01")]


def candump(*rows: tuple[int, str, bool]) -> str:
    """rows: time in ms, channel, whether it is an error frame."""
    words = {True: "20000088#0000080000000000", False: "703#00"}
    return "".join(f"({ms / 1e3:.6f}) {on} {words[is_error]}\n" for ms, on, is_error in rows)


@pytest.mark.parametrize(
    ("rows", "times"),
    [
        ("aaa", [("a", 3)]),
        ("aab", [("a", 2), ("b", 1)]),
        ("abab", [("a", 1), ("b", 1), ("a", 1), ("b", 1)]),
        ("a-a", [("a", 1), ("a", 1)]),
        ("abb", [("a", 1), ("b", 2)]),
    ],
)
def test_error_frames_in_a_row_are_one_line_for_each_segment(
    rows: str, times: list[tuple[str, int]], tmp_path: Path
) -> None:
    given = [(10 * n, "b" if on == "b" else "a", on != "-") for n, on in enumerate(rows, 1)]
    lines = lines_of(tmp_path / "some.log", candump(*given))
    errors = [line for line in lines if "error frame" in line]
    found = []
    for line in errors:
        words = line.split()
        count = int(words[words.index("times") - 1]) if "times" in words else 1
        found.append((words[1], count))
        if count > 1:
            last_ms = max(ms for ms, on, _ in given if on == words[1])
            assert line.endswith(f"{count} times until {last_ms:.3f} ms")
    assert found == times
