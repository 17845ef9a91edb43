"""The section "Real time" of a run on a real bus: what it says of which figures."""

from dataclasses import replace
from typing import Any

import pytest

from axisrig.bench.record.bus import RealTime, Spread
from axisrig.reports.parts.realtime import real_time

FIGURES = RealTime(
    period_us=1000.0,
    late_us=250.0,
    cycles=400,
    late_cycles=3,
    lateness_us=Spread(0.0, 12.4, 310.0, 12_340.0),
    interval_us=Spread(640.0, 1000.0, 1400.0, 10_000.0),
    bins_us=(0.0, 100.0, 10_000.0),
    histogram=(300, 99, 1),
    slips=0,
    slipped_ms=0.0,
    waits=0,
    waited_ms=0.0,
    send_errors=0,
)


def test_a_run_in_simulated_time_or_without_a_cycle_has_none() -> None:
    assert real_time(None) is None
    assert real_time(replace(FIGURES, cycles=0, lateness_us=None)) is None


def test_figures_have_their_units_and_shares() -> None:
    """From 10 ms on in ms."""
    found = real_time(FIGURES)
    assert found is not None
    assert found["rows"] == [
        ("SYNCs sent", "400"),
        ("later than 250 µs", "3 (0.75 %)"),
        ("lateness: median", "12 µs"),
        ("lateness: 99 % below", "310 µs"),
        ("lateness: largest", "12.3 ms"),
        ("SYNC interval, asked for 1000 µs", "640 µs to 10.0 ms"),
    ]
    assert [tuple(row.values()) for row in found["histogram"]] == [
        ("0 µs to 100 µs", "300", "75.00"),
        ("100 µs to 10.0 ms", "99", "24.75"),
        ("10.0 ms and more", "1", "0.25"),
    ]
    without = real_time(replace(FIGURES, interval_us=None))
    assert without is not None
    assert without["rows"] == found["rows"][:-1]


def test_numbers_of_a_sentence_are_its_own() -> None:
    """Times that the plan moved and that cycles waited are two, both in ms."""
    found = real_time(replace(FIGURES, slips=3, slipped_ms=7.25, waits=5, waited_ms=1234.5,
                              send_errors=9))  # fmt: skip
    assert found is not None
    _, slipped, waited, refused = found["words"]
    assert (
        "its plan 3 times by more than a quarter of the period; the plan then moved, 7.2 ms in"
        in slipped
    )
    assert waited.startswith("5 cycles waited for the answers of the drives, 1234.5 ms in all")
    assert refused == "The interface did not take 9 frames."


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.4, "0 µs"), (0.6, "1 µs"), (9999.0, "9999 µs"), (1e4, "10.0 ms"), (1.5e6, "1500.0 ms")],
)  # fmt: skip
def test_a_time_is_in_ms_from_10_ms_on(value: float, text: str) -> None:
    """The period, and what was asked for, in the same units as what came."""
    found = real_time(
        replace(FIGURES, period_us=value, interval_us=Spread(value, value, value, value))
    )
    assert found is not None
    assert found["rows"][-1] == (f"SYNC interval, asked for {text}", f"{text} to {text}")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ()),
        ({"slips": 2, "slipped_ms": 7.25}, ("missed its plan 2 times",)),
        ({"waits": 5, "waited_ms": 3.0}, ("5 cycles waited",)),
        ({"send_errors": 4}, ("did not take 4 frames",)),
        (
            {"slips": 1, "waits": 1, "send_errors": 1},
            ("missed its plan 1 times", "1 cycles waited", "did not take 1 frames"),
        ),
    ],
)
def test_what_it_means_is_said_where_it_happened(
    changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    found = real_time(replace(FIGURES, **changes))
    assert found is not None
    first, *more = found["words"]
    assert first.startswith("A late SYNC does not move a latch")
    assert len(more) == len(words)
    assert all(word in text for word, text in zip(words, more, strict=True))
