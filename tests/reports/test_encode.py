"""Signals through the report's encoding and back, by a decoder written from its description."""

import base64
import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from tests.page_scripts import needs_node, value_in_node
from tests.reports.pages import opened

from axisrig.reports.build import build_report
from axisrig.reports.parts.encode import encode_signal, pack

Array = npt.NDArray[np.float64]


def decode(
    octets: bytes, rows: int, start: int, planes: int, digits: int, gaps: list[Any]
) -> Array:
    """Undo the four steps with plain integers."""
    values, total = [], start
    for row in range(rows):
        step = sum(octets[plane * rows + row] << (8 * plane) for plane in range(planes))
        total += -(step + 1) // 2 if step % 2 else step // 2
        values.append(total / 10**digits)
    result = np.array(values)
    for first, count in gaps:
        result[first : first + count] = np.nan
    return result


def back(values: Array, digits: int) -> Array:
    head, octets = encode_signal(values, digits)
    assert len(octets) == head.planes * len(values)
    return decode(octets, len(values), head.start, head.planes, head.digits, head.gaps)


def test_nanometres_over_metres_come_back_exactly() -> None:
    values = np.array([0.0, 4000.000001, -4000.0, 1e-6, -1e-6, 12.345678])
    assert back(values, 6).tolist() == values.tolist()


def test_gaps_come_back_as_gaps() -> None:
    values = np.array([np.nan, 1.0, np.nan, np.nan, 2.0, np.nan])
    np.testing.assert_array_equal(back(values, 3), values)


def test_a_constant_costs_one_plane_and_a_single_sample_works() -> None:
    head, octets = encode_signal(np.full(1000, 123.456), 6)
    assert (head.planes, len(octets)) == (1, 1000)
    assert back(np.array([7.5]), 1).tolist() == [7.5]


def test_a_signal_has_as_many_planes_as_its_largest_difference_has_bytes() -> None:
    """Differences of -128 to 127 are 0 to 255 in zig-zag, one byte."""
    for difference, planes in (
        (127, 1), (-128, 1), (128, 2), (-129, 2), (32_767, 2), (-32_768, 2), (32_768, 3),
    ):  # fmt: skip
        head, octets = encode_signal(np.array([5.0, 5.0 + difference]), 0)
        assert (head.planes, len(octets)) == (planes, 2 * planes), difference


def test_time_in_nanoseconds_is_exact() -> None:
    time_ns = np.array([0, 1_000_000, 2_000_001, 9_007_199_254_740_991], dtype=np.int64)
    head, octets = encode_signal(time_ns, 0)
    assert decode(octets, 4, head.start, head.planes, 0, []).tolist() == time_ns.tolist()


def test_values_beyond_the_range_are_refused() -> None:
    with pytest.raises(OverflowError):
        encode_signal(np.array([1e15]), 6)


LARGEST = float(2**62 - 512)
"""The next one that a double has is 2^62: between 2^61 and 2^62 they are 512 apart."""


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("steps", [2.0**62, 2.0**62 + 1024, 6e18, 9e18, 1e300, np.inf])
def test_the_range_ends_before_the_differences_of_64_bits_do(sign: float, steps: float) -> None:
    """Of two values at its ends the difference is below 2^63 still; gaps are no values."""
    with pytest.raises(OverflowError, match="0 decimal places"):
        encode_signal(np.array([0.0, sign * steps, np.nan]), 0)
    ends = np.array([-LARGEST, LARGEST, np.nan, -LARGEST]) * sign
    np.testing.assert_array_equal(back(ends, 0), ends)


@pytest.mark.long
@given(hnp.arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e6, 1e6)))
def test_no_value_is_off_by_more_than_half_a_step(values: Array) -> None:
    off = np.abs(back(values, 6) - values)
    # Both ends of the difference are rounded to a double
    assert (off <= 0.5e-6 + np.spacing(np.abs(values))).all()


@pytest.mark.long
def test_the_page_holds_every_sample_of_the_trace(campaign: Path) -> None:
    runs = opened(build_report(campaign))
    assert sum(bool(run.packed) for run in runs.values()) == 12
    trace = pq.read_table(campaign / "traces" / "probing-feed_1_a.parquet")
    chart, packed = runs["probing-feed_1_a"].chart, runs["probing-feed_1_a"].packed
    octets, offset = gzip.decompress(base64.b64decode(packed)), 0
    for head in chart["columns"]:
        size = head["planes"] * chart["rows"]
        part = octets[offset : offset + size]
        offset += size
        name, rest = head["name"], {k: v for k, v in head.items() if k != "name"}
        found = decode(part, chart["rows"], **rest)
        truth = trace.column(name).to_numpy()
        assert np.abs(found - truth).max() <= 0.500001 * 10.0 ** -head["digits"], name
    assert offset == len(octets)


@pytest.mark.long
@needs_node
def test_the_script_of_the_page_decodes_what_python_encodes() -> None:
    """All signals of a run one after the other, and their time in ms."""
    values = np.array([0.0, 4000.000001, -4000.0, np.nan, -1e-6, 12.345678])
    columns = {"time_ns": (np.arange(6.0) * 2e6 - 1e6, 0), "x": (values, 6), "y": (values[::-1], 1)}
    heads, octets = zip(*(encode_signal(*one) for one in columns.values()), strict=True)
    chart = {
        "rows": len(values),
        "columns": [
            {"name": name, "start": head.start, "planes": head.planes, "digits": digits,
             "gaps": head.gaps}
            for (name, (_, digits)), head in zip(columns.items(), heads, strict=True)
        ],
    }  # fmt: skip
    folder = Path(build_report.__code__.co_filename).parent
    scripts = [folder / "vendor" / "pako" / "pako_inflate.min.js", folder / "plots.js"]
    found = value_in_node(
        f"axisrigPlots.decode({json.dumps(chart)}, {json.dumps(pack(list(octets)))})", scripts,
        "globalThis.exports = undefined;",
    )  # fmt: skip
    assert found == {
        "time_ns": [-1e6, 1e6, 3e6, 5e6, 7e6, 9e6],
        "x": [0, 4000.000001, -4000, None, -1e-6, 12.345678],
        "y": [12.3, 0, None, -4000, 4000, 0],
        "time_ms": [-1, 1, 3, 5, 7, 9],
    }


@pytest.mark.parametrize(
    ("value", "digits", "step"),
    [(0.6, 0, 1), (0.4, 0, 0), (-0.6, 0, -1), (-0.4, 0, 0), (1.5, 0, 2), (2.5, 0, 2), (-1.5, 0, -2),
     (0.00126, 4, 13), (-0.00126, 4, -13), (0.00124, 4, 12), (9.9996, 3, 10_000)],
)  # fmt: skip
def test_a_value_is_rounded_to_the_nearest_step(value: float, digits: int, step: int) -> None:
    """In the middle of two to the even one; beside a gap as without one."""
    assert encode_signal(np.array([value]), digits)[0].start == step
    assert encode_signal(np.array([value, np.nan]), digits)[0].start == step
    assert back(np.array([0.0, value, np.nan, value]), digits).tolist()[1::2] == pytest.approx(
        [step / 10**digits] * 2, rel=1e-12
    )
