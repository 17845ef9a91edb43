"""Of several blocks of a tool centre point the worst counts, wherever in the program it is.

`reports/tilted.py`: from 300 ms on the tool goes along Y with 50 mm/s, tilted and at rest
otherwise; axes are two cycles later where they were sent.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import permutations

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import Step, block_trace, kept
from tests.reports import tilted

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.time.clock import MS

PARTS = ((301, 341), (341, 371), (371, 391))
"""Begin and end of three blocks, ms: rows 300 to 340 to 370 to 390, carried out 2 rows later."""
INSIDE = (322, 357, 382)
"""A row within each of them, as the axes carry it out."""
LINE, BETWEEN, SPEED = "tcp_from_line_um_max", "tcp_between_um_max", "tcp_velocity_mm_s_max"


def recorded(
    off: Mapping[str, Mapping[int, float]],
    kinds: tuple[str, ...] = ("feed",) * 3,
    kinematics: tuple[KinematicRecord, ...] | None = None,
) -> Observed:
    """off: what is added to a column in some rows; kinds: of the three blocks."""
    table = tilted.trace()
    for name, rows in off.items():
        values = table[name].to_numpy().copy()
        for row, more in rows.items():
            values[row] += more
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    steps = [
        Step(f"N{10 * place} G1 Y9", kind, begin, begin, end)
        for place, (kind, (begin, end)) in enumerate(zip(kinds, PARTS, strict=True), start=1)
    ]
    of = replace(tilted.left(), timing=Timing(MS, 600_000, 0), blocks=block_trace(steps))
    if kinematics is not None:
        of = replace(of, kinematics=kinematics)
    return Observed(of, kept(table))


def seen(observed: Observed, metric: str) -> Observation:
    return observe(observed, parse_check(metric, "> -1e9", ""))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("sizes", list(permutations((0.01, 0.02, 0.03))), ids=str)
def test_the_fastest_step_counts_in_whichever_block(sizes: tuple[float, ...], side: float) -> None:
    """0.05 mm a cycle; a row that is 0.03 mm farther makes one step 0.08 mm long."""
    along = {row: side * size for row, size in zip(INSIDE, sizes, strict=True)}
    observed = recorded({"Y.truth_mm": along})
    assert seen(observed, SPEED).value == pytest.approx(80.0)


@pytest.mark.parametrize(
    ("kinds", "line_um", "speed_mm_s"),
    [
        (("rapid", "feed", "feed"), 30.0, np.hypot(50.0, 20.0)),
        (("feed", "rapid", "feed"), 30.0, np.hypot(50.0, 30.0)),
        (("arc", "feed", "arc"), 20.0, np.hypot(50.0, 20.0)),
        (("arc", "arc", "feed"), 10.0, np.hypot(50.0, 10.0)),
        (("arc", "rapid", "measurement run"), 20.0, np.hypot(50.0, 10.0)),
        (("rapid", "rapid", "rapid"), 30.0, None),
        (("arc", "arc", "arc"), None, None),
    ],
)
def test_straight_blocks_have_a_line_and_those_with_a_feed_a_speed(
    kinds: tuple[str, ...], line_um: float | None, speed_mm_s: float | None
) -> None:
    """Across the line by 30, 20 and 10 um in one row each: so much more way of that cycle."""
    away = dict(zip(INSIDE, (0.03, 0.02, 0.01), strict=True))
    observed = recorded({"X.truth_mm": away}, kinds)
    for metric, expected in ((LINE, line_um), (BETWEEN, line_um), (SPEED, speed_mm_s)):
        found = seen(observed, metric).value
        assert found == (None if expected is None else pytest.approx(expected, abs=1e-6)), metric


def on(begin_ms: int, end_ms: int | None, tool_mm: float = tilted.TOOL_MM) -> KinematicRecord:
    end_ns = None if end_ms is None else end_ms * MS
    return KinematicRecord(begin_ms * MS, end_ns, tilted.AXES, (9, 98), tool_mm)


@pytest.mark.parametrize(
    ("kinematics", "line_um"),
    [
        ((on(50, 341), on(341, None)), 30.0),
        ((on(50, 341),), 10.0),  # blocks that begin after it are none of it
        ((on(341, None),), 30.0),
        ((on(340, 342), on(371, 372)), 30.0),  # one that is on at the begin of a block counts
        ((on(342, 371),), None),
        ((on(50, 301), on(341, 342)), 20.0),
    ],
)
def test_a_block_counts_by_the_kinematic_that_is_on_at_its_begin(
    kinematics: tuple[KinematicRecord, ...], line_um: float | None
) -> None:
    away = dict(zip(INSIDE, (0.01, 0.02, 0.03), strict=True))
    observed = recorded({"X.truth_mm": away}, kinematics=kinematics)
    found = seen(observed, LINE)
    assert found.value == (None if line_um is None else pytest.approx(line_um, abs=1e-6))
    if line_um is None:
        assert found.note == "no straight block was carried out while a kinematic was on"


def test_each_block_has_the_tool_of_its_own_kinematic() -> None:
    """A of the axes is off by 0.01 degrees in the first and in the last block.

    The tool centre point is 100 mm and the tool away from A: 180 mm, and 140 mm with a tool of 40.
    """
    off_deg = 0.01
    lengths = {80.0: 180.0, 40.0: 140.0}
    for first_mm, last_mm in ((80.0, 40.0), (40.0, 80.0)):
        both = (on(50, 341, first_mm), on(341, None, last_mm))
        for row, tool_mm in ((INSIDE[0], first_mm), (INSIDE[2], last_mm)):
            observed = recorded({"A.truth_deg": {row: off_deg}}, kinematics=both)
            # The point goes along du/da, and the block along Y
            way_um = 1e3 * lengths[tool_mm] * np.radians(off_deg)
            c, a = np.radians(tilted.C_DEG), np.radians(tilted.A_DEG)
            moved = np.array([np.sin(c) * np.cos(a), -np.cos(c) * np.cos(a), -np.sin(a)])
            across_um = way_um * np.hypot(moved[0], moved[2])
            assert seen(observed, LINE).value == pytest.approx(across_um, rel=1e-3)


@pytest.mark.parametrize(
    ("row", "along_mm", "speed_mm_s"),
    [
        (302, -0.01, 60.0),  # the first step begins with it
        (302, 0.01, 50.0),
        (301, -0.02, 50.0),  # the step before
        (392, 0.01, 60.0),  # the last one ends with it
        (392, -0.01, 50.0),
        (393, 0.02, 50.0),  # the step after
    ],
)
def test_speeds_are_those_of_the_steps_in_which_the_axes_carry_a_block_out(
    row: int, along_mm: float, speed_mm_s: float
) -> None:
    """One block of rows 300 to 390 is carried out from row 302 to 392 with 0.05 mm a cycle."""
    observed = recorded({"Y.truth_mm": {row: along_mm}})
    steps = [Step("N10 G1 Y9", "feed", 301, 301, 391)]
    whole = Observed(replace(observed.facts, blocks=block_trace(steps)), observed.series)
    assert seen(whole, SPEED).value == pytest.approx(speed_mm_s)


@pytest.mark.parametrize(("begin_ms", "has_line"), [(0.5, False), (1, True), (2, True)])
def test_a_block_begins_with_the_row_before_its_first_cycle(
    begin_ms: float, has_line: bool
) -> None:
    """In the first row nothing was before it: there is no place where it started."""
    steps = [Step("N10 G1 Y9", "feed", begin_ms, begin_ms, 30)]
    observed = recorded({"X.truth_mm": {4: 0.02}}, kinematics=(on(0, None),))
    whole = Observed(replace(observed.facts, blocks=block_trace(steps)), observed.series)
    found = seen(whole, LINE).value
    assert found == (pytest.approx(20.0, abs=1e-6) if has_line else None)


def test_a_short_block_has_a_line_too() -> None:
    """Of one cycle, 0.05 mm: its ends are on the line, and 30 um across it is away from it."""
    steps = [Step("N10 G1 Y9", "feed", 341, 341, 342)]
    for row, away_mm, line_um in ((343, 0.0, 0.0), (342, 0.03, 30.0), (343, 0.02, 20.0)):
        observed = recorded({"X.truth_mm": {row: away_mm}})
        whole = Observed(replace(observed.facts, blocks=block_trace(steps)), observed.series)
        assert seen(whole, LINE).value == pytest.approx(line_um, abs=1e-6)
        assert seen(whole, BETWEEN).value == pytest.approx(line_um, abs=1e-6)
