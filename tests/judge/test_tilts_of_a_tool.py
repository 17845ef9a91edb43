"""Times in which a tool tilts about a point that rests: how many, and what may be wrong in them.

The recording is that of `reports/tilted.py`: from row 50 to 250 A goes to -35 and C to 20 degrees.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import product

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, kept
from tests.reports import tilted
from tests.reports.tilted import AXES, KINEMATIC, TILTED, direction, left, trace

from axisrig.bench.judge.distance.tilting import Tilts, tilts
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.errors import NoClosedFormError

REACH_MM = tilted.LEVER_MM + tilted.TOOL_MM
LATE, TURN = 2, TILTED - KINEMATIC


def found(
    table: pa.Table,
    offset: range = range(0),
    off_row: int | None = None,
    per_mm: Mapping[str, float] | None = None,
) -> Tilts:
    """offset: rows with something superposed on Z. off_row: from which on the kinematic is off."""
    values = table["Z.superposed_mm"].to_numpy().copy()
    values[[*offset]] += 0.5
    table = table.set_column(
        table.column_names.index("Z.superposed_mm"), "Z.superposed_mm", pa.array(values)
    )
    facts = left()
    (on,) = facts.kinematics
    axes = {
        name: replace(axis, increments_per_mm=(per_mm or {}).get(name, axis.increments_per_mm))
        for name, axis in facts.axes.items()
    }
    end_ns = on.end_ns if off_row is None else off_row * MS
    facts = replace(facts, axes=axes, kinematics=(replace(on, end_ns=end_ns),))
    return tilts(Observed(facts, kept(table)))


def at(c_deg: float, a_deg: float) -> np.ndarray:
    """The direction of the tool."""
    (way,) = direction(np.array([c_deg]), np.array([a_deg]))
    return np.asarray(way)


def rounding_mm(a_deg: float, c_deg: float, halves: Mapping[str, float]) -> float:
    """All signs of half an increment of every axis, of C and A at the reach of the tool."""
    by_c, by_a = (
        REACH_MM * (at(c_deg + dc, a_deg + da) - at(c_deg - dc, a_deg - da)) / 2e-4
        for dc, da in ((1e-4, 0.0), (0.0, 1e-4))
    )
    columns = np.column_stack([*np.eye(3), by_c, by_a]) * [halves[name] for name in AXES]
    return max(
        float(np.linalg.norm(columns @ np.array(signs))) for signs in product((1, -1), repeat=5)
    )


@pytest.mark.parametrize("name", AXES)
def test_each_axis_has_its_own_increments(name: str) -> None:
    """One of them is twenty times as coarse: it makes most of the rounding, as all of them say."""
    per_mm = {axis: 500.0 if axis == name else 10_000.0 for axis in AXES}
    halves = {axis: 0.5 / count for axis, count in per_mm.items()}
    shares = np.linspace(0.0, 1.0, TURN + 1)
    expected = max(
        rounding_mm(share * tilted.A_DEG, share * tilted.C_DEG, halves) for share in shares[::4]
    )
    got = found(trace(), per_mm=per_mm).rounding_mm
    assert got == pytest.approx(expected, rel=2e-3)


def test_of_several_times_the_largest_rounding_and_chord_count_and_all_cycles() -> None:
    """What is largest as a whole is so in its parts, whether it is in the first or the last one."""
    whole = found(trace())
    parted = found(trace(), offset=range(150, 160))
    assert parted.rounding_mm == pytest.approx(whole.rounding_mm, rel=1e-9)
    assert parted.chord_mm == pytest.approx(whole.chord_mm, rel=1e-9)
    # Rows 52 .. 151 and 161 .. 252, with the row before the first turn of each
    assert (whole.cycles, parted.cycles) == (TURN + 1, 100 + 92)
    first = found(trace(), offset=range(150, TILTED + 1))
    last = found(trace(), offset=range(KINEMATIC, 150))
    assert (first.cycles, last.cycles) == (100, 102)  # turns of 51 .. 149 and 150 .. 250
    assert first.rounding_mm < last.rounding_mm == pytest.approx(whole.rounding_mm)
    assert first.chord_mm < last.chord_mm == pytest.approx(whole.chord_mm)


@pytest.mark.parametrize(("rows", "is_judged"), [(3, False), (4, False), (5, True), (20, True)])
def test_a_kinematic_that_goes_off_leaves_five_cycles_at_least(rows: int, is_judged: bool) -> None:
    """What is sent in row 50 is reached in row 52: so many rows are left until it is off."""
    off = KINEMATIC + LATE + rows
    if is_judged:
        assert found(trace(), off_row=off).cycles == rows
        return
    with pytest.raises(NoClosedFormError, match="was switched off before the tool had tilted"):
        found(trace(), off_row=off)


@pytest.mark.parametrize(("rows", "is_judged"), [(3, False), (4, True)])
def test_a_tilt_of_five_rows_is_one(rows: int, is_judged: bool) -> None:
    """Four turns have five rows: the one before the first of them is part of it."""
    begin = KINEMATIC + 1
    offset = range(begin + rows, TILTED + 1)
    if is_judged:
        assert found(trace(), offset=offset).cycles == rows + 1
        return
    with pytest.raises(NoClosedFormError, match="never at rest while the tool tilted"):
        found(trace(), offset=offset)


@pytest.mark.parametrize("axis", ["X", "Y", "C", "A"])
def test_an_offset_of_any_axis_ends_a_time(axis: str) -> None:
    table = trace()
    name = f"{axis}.superposed_{'deg' if axis in 'CA' else 'mm'}"
    values = table[name].to_numpy().copy()
    values[150:160] -= 0.5
    table = table.set_column(table.column_names.index(name), name, pa.array(values))
    assert found(table).cycles == 100 + 92


def test_a_chord_has_both_rotary_axes() -> None:
    """(sqrt(L1) d1 + sqrt(L2) d2)^2/8, L the lever and d the turn of a cycle in rad."""
    lever_mm = REACH_MM * math.sin(math.radians(abs(tilted.A_DEG)))
    turns = [math.radians(abs(deg)) / TURN for deg in (tilted.A_DEG, tilted.C_DEG)]
    both = (math.sqrt(REACH_MM) * turns[0] + math.sqrt(lever_mm) * turns[1]) ** 2 / 8.0
    assert found(trace()).chord_mm == pytest.approx(both, rel=1e-6)
    assert found(trace(c_deg=0.0)).chord_mm == pytest.approx(REACH_MM * turns[0] ** 2 / 8.0)
