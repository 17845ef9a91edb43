"""Smallest and largest values of a trace: nothing that a plot of the whole run shows is lost."""

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.reports.parts.envelope import BINS, KEPT_ROWS, envelope

MS = 1_000_000


def trace(values: np.ndarray) -> pa.Table:
    time_ns = np.arange(len(values), dtype=np.int64) * MS
    return pa.table({"time_ns": time_ns, "Z.actual_mm": values})


def column(table: pa.Table, name: str) -> np.ndarray:
    return np.asarray(table.column(name).to_numpy())


def test_a_short_trace_comes_back_as_it_is() -> None:
    table = trace(np.arange(2.0 * BINS + KEPT_ROWS))
    assert envelope(table, []) is table


@pytest.mark.long
@settings(max_examples=30, deadline=None)
@given(st.integers(2 * BINS + KEPT_ROWS + 1, 30_000), st.integers(0, 2**31))
def test_no_peak_is_lost_and_no_value_is_made_up(rows: int, seed: int) -> None:
    """Each bin of consecutive rows has its own extremes, reckoned here row by row."""
    values = np.random.default_rng(seed).normal(size=rows)
    reduced = envelope(trace(values), [])
    time_ns, found = column(reduced, "time_ns"), column(reduced, "Z.actual_mm")
    assert len(found) <= 2 * BINS
    assert (np.diff(time_ns) > 0).all()
    assert (time_ns[0], time_ns[-1]) == (0, (rows - 1) * MS)
    size = -(-rows // BINS)
    for number, first in enumerate(range(0, rows, size)):
        own = values[first : first + size]
        if len(own) > 1:
            assert sorted(found[2 * number : 2 * number + 2]) == [own.min(), own.max()]


def test_a_spike_of_one_sample_stays() -> None:
    values = np.zeros(20_000)
    values[12_345] = 7.0
    assert column(envelope(trace(values), []), "Z.actual_mm").max() == 7.0


def test_stretches_with_a_button_keep_every_sample() -> None:
    values = np.random.default_rng(1).normal(size=20_000)
    begin, end = 5_003, 5_203
    reduced = envelope(trace(values), [(begin * MS, end * MS)])
    time_ns = column(reduced, "time_ns")
    inside = (time_ns >= begin * MS) & (time_ns <= end * MS)
    np.testing.assert_array_equal(time_ns[inside], np.arange(begin, end + 1) * MS)
    np.testing.assert_array_equal(column(reduced, "Z.actual_mm")[inside], values[begin : end + 1])
    assert reduced.num_rows <= 2 * BINS + KEPT_ROWS + 4


def test_a_stretch_that_is_too_long_is_reduced_and_a_later_one_stays() -> None:
    values = np.random.default_rng(2).normal(size=20_000)
    long, short = (0, 10_000 * MS), (15_000 * MS, 15_010 * MS)
    time_ns = column(envelope(trace(values), [long, short]), "time_ns")
    assert len(time_ns[time_ns <= long[1]]) < 2 * BINS
    assert set(range(15_000, 15_011)) <= set((time_ns // MS).tolist())


@pytest.mark.parametrize(("count", "stays"), [(KEPT_ROWS, True), (KEPT_ROWS + 1, False)])
def test_a_stretch_may_have_all_the_rows_that_are_kept(count: int, stays: bool) -> None:
    """400 of them; of one more the rows are taken together like the rest."""
    values = np.random.default_rng(4).normal(size=20_000)
    begin = 7_003
    reduced = envelope(trace(values), [(begin * MS, (begin + count - 1) * MS)])
    time_ns = column(reduced, "time_ns") // MS
    inside = time_ns[(time_ns >= begin) & (time_ns < begin + count)]
    assert (len(inside) == count) is stays


def test_stretches_share_the_rows_that_are_kept() -> None:
    """The first has 300, the second would have 200: it is taken together, a third of 90 stays.

    Rows that two stretches have count once.
    """
    values = np.random.default_rng(5).normal(size=20_000)

    def kept(*spans: tuple[int, int]) -> list[bool]:
        given = [(begin * MS, (begin + count - 1) * MS) for begin, count in spans]
        times = set((column(envelope(trace(values), given), "time_ns") // MS).tolist())
        return [set(range(begin, begin + count)) <= times for begin, count in spans]

    assert kept((1_003, 300), (5_003, 200), (9_003, 90)) == [True, False, True]
    assert kept((1_003, 300), (1_203, 200)) == [True, True]


def test_samples_without_a_value_stay_gaps_where_a_bin_has_none() -> None:
    values = np.ones(20_000)
    values[4_000:8_000] = np.nan
    reduced = envelope(trace(values), [])
    found, time_ns = column(reduced, "Z.actual_mm"), column(reduced, "time_ns") // MS
    assert np.isnan(found[(time_ns > 4_100) & (time_ns < 7_900)]).all()
    assert (found[(time_ns < 3_900) | (time_ns > 8_100)] == 1.0).all()


def test_whole_numbers_stay_whole() -> None:
    signal = (np.arange(20_000) > 9_000).astype(np.int8)
    table = pa.table({"time_ns": np.arange(20_000) * MS, "probe.signal": signal})
    reduced = envelope(table, [])
    assert reduced.column("probe.signal").type == pa.int8()
    assert set(column(reduced, "probe.signal").tolist()) == {0, 1}


@pytest.mark.parametrize(("first", "last"), [(0.0, 1.0), (1.0, 0.0)])
def test_the_ends_of_a_bin_are_in_the_order_of_the_signal(first: float, last: float) -> None:
    """20 000 rows are 400 bins of 50; each rises, or falls, from its first row to its last."""
    values = np.tile(np.linspace(first, last, 20_000 // BINS), BINS)
    reduced = envelope(trace(values), [])
    assert column(reduced, "Z.actual_mm").tolist() == [first, last] * BINS
    rows = column(reduced, "time_ns") // MS
    assert rows.tolist() == [row for n in range(BINS) for row in (50 * n, 50 * n + 49)]


def test_a_bin_shows_the_values_that_it_has_beside_samples_without_one() -> None:
    """Of 50 rows one has a value, 3, in its middle: smallest and largest."""
    values = np.ones(20_000)
    values[10_000:10_050] = np.nan
    values[10_020] = 3.0
    reduced = envelope(trace(values), [])
    rows, found = column(reduced, "time_ns") // MS, column(reduced, "Z.actual_mm")
    assert found[(rows >= 10_000) & (rows < 10_050)].tolist() == [3.0, 3.0]
    assert set(found.tolist()) == {1.0, 3.0}
