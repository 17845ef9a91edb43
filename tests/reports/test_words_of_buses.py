"""Rows of buses and lines on the page, and the words for counts and units."""

import pytest

from axisrig.bench.record.bus import BusFigures, LineFigures, Waiting
from axisrig.reports.parts.buses import bus_row, line_facts
from axisrig.reports.parts.words import counted_of, metric_words, shown_unit


@pytest.mark.parametrize(
    ("bits_s", "words"),
    [(1_000_000, "1000 kbit/s"), (1_000_001, "1 Mbit/s"), (500_000, "500 kbit/s"),
     (12_000_000, "12 Mbit/s"), (100_000_000, "100 Mbit/s"), (83_333, "83.333 kbit/s")],
)  # fmt: skip
def test_a_bit_rate_of_can_is_in_kbit_and_a_faster_one_in_mbit(bits_s: int, words: str) -> None:
    """CiA 301 has bit rates in kbit/s, up to 1000."""
    figures = BusFigures("can1", bits_s, 12.34, 56.78, 99.95, 7, 1, "o", (("Z", 8, 0, "x"),), ())
    shown = bus_row(figures)
    assert (shown["bitrate"], shown["loads"]) == (words, ["12.3", "56.8", "100.0"])
    assert (shown["segment"], shown["frames"], shown["line"]) == ("can1", 7, [])
    assert (shown["error_frames"], shown["overload"]) == (1, "o")
    assert shown["counters"] == [{"port": "Z", "tec": 8, "rec": 0, "state": "x"}]


def test_frames_that_waited_have_their_name_identifier_and_time() -> None:
    """In hexadecimal, 11 bits in three digits, 29 bits in eight; in us with a tenth.

    Bit 31 of a recording marks 29 bits: it is no part of the identifier.
    """
    waiting = (Waiting("Z.TPDO1", "Z", 0x181, 120.04), Waiting("SYNC", "", 0x80, 0.06),
               Waiting("X", "X", 1 << 31 | 0x1800_0181, 7.0),
               Waiting("Y", "", 1 << 31 | 0x181, 7.0))  # fmt: skip
    shown = bus_row(BusFigures("can1", 500_000, 1.0, 2.0, 3.0, 7, 0, "", (), waiting))
    assert shown["waiting"] == [
        {"name": "Z.TPDO1", "id": "181", "us": "120.0"},
        {"name": "SYNC", "id": "080", "us": "0.1"},
        {"name": "X", "id": "18000181", "us": "7.0"},
        {"name": "Y", "id": "00000181", "us": "7.0"},
    ]


@pytest.mark.parametrize(
    ("back", "wrong", "in_a_row", "expected"),
    [
        (100, 0, 0, ["100, not back 0", "6, another one in 0 frames"]),
        (99, 1, 0, ["100, not back 1", "6, another one in 1 frames"]),
        (98, 1, 1, ["100, not back 2", "6, another one in 1 frames"]),
        (100, 3, 2, ["100, not back 0", "6, another one in 3 frames, 2 in a row"]),
    ],
)
def test_what_went_wrong_on_a_line_is_marked(
    back: int, wrong: int, in_a_row: int, expected: list[str]
) -> None:
    line = LineFigures(
        period_us=1000.0, wire_us=12.356, sent=100, back=back, counter=6, wrong=wrong,
        wrong_in_a_row=in_a_row, slaves=(("Z", "OP"), ("X", "SAFEOP")),
    )  # fmt: skip
    cycle, frames, counter, *states = line_facts(line)
    assert cycle == ("cycle", "1000 µs, of it the frame 12.36 µs", False)
    assert [frames[1], counter[1]] == expected
    assert (frames[2], counter[2]) == (back < 100, wrong > 0)
    assert states == [("Z: AL state", "OP", False), ("X: AL state", "SAFEOP", True)]


@pytest.mark.parametrize(
    ("count", "of", "what", "words"),
    [(3, 3, "run", "all 3 runs"), (1, 1, "run", "the one run"), (1, 3, "run", "1 of 3 runs"),
     (1, 1, "case", "the one case"), (0, 2, "case", "0 of 2 cases"), (0, 1, "run", "0 of 1 runs")],
)  # fmt: skip
def test_how_many_of_how_many(count: int, of: int, what: str, words: str) -> None:
    assert counted_of(count, of, what) == words


def test_units_as_a_reader_writes_them() -> None:
    assert [shown_unit(each) for each in ("um", "pct", "mm", "um_s")] == ["µm", "%", "mm", "µm_s"]
    assert (metric_words("m", "um"), metric_words("m", "")) == ("m, µm", "m")
