"""No axis moves to a place that a telegram alone reports, whenever it begins to be altered.

Bit 20 of the position is 10 mm at 104 857.6 increments/mm: within the software limits.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

RunNc = Callable[..., Any]
PROGRAM = "N10 G4 X0.02\nN20 M30"
STILL_MM = 0.01
ALTERED = "fault:alter=Z.TPDO1 byte=5 xor=0x10"
EVERY_MS = range(30)


def moved_mm(outcome: Any) -> float:
    return float(np.ptp(outcome.column("Z.truth_mm")))


def test_an_axis_with_right_telegrams_starts(run_nc: RunNc) -> None:
    outcome = run_nc(PROGRAM, "")
    assert outcome.alarms == []
    assert moved_mm(outcome) < STILL_MM


def test_telegrams_that_are_altered_from_the_first_one_on_move_nothing(run_nc: RunNc) -> None:
    outcome = run_nc(PROGRAM, "", ALTERED)
    assert outcome.alarms == [900084]
    assert moved_mm(outcome) < STILL_MM


def test_without_the_proof_the_axis_jumps(run_nc: RunNc) -> None:
    """So the test of before sees the jump of an axis that is led from a wrong place."""
    outcome = run_nc(PROGRAM, "[drive.servo]\nposition_check = false\n", ALTERED)
    assert moved_mm(outcome) > STILL_MM


@pytest.mark.long
@pytest.mark.parametrize("at_ms", EVERY_MS)
def test_whenever_it_begins_nothing_moves(run_nc: RunNc, at_ms: int) -> None:
    outcome = run_nc(PROGRAM, "", f"{ALTERED} at={at_ms}ms")
    assert outcome.alarms, "the telegrams are wrong to the end"
    assert moved_mm(outcome) < STILL_MM


@pytest.mark.long
@pytest.mark.parametrize("at_ms", [100, 400, 800])
def test_a_reference_that_telegrams_alone_report_is_not_taken(run_nc: RunNc, at_ms: int) -> None:
    """While a drive looks for its reference the position may jump; at its end SDO reports it too.

    The drive goes at most 6099; 10 mm in a cycle would be 10 m/s.
    """
    fault = f"{ALTERED} at={at_ms}ms"
    outcome = run_nc("N10 G74 Z1\nN20 M30", "", fault, base="homing-z-g74.toml")
    assert outcome.alarms == [900084]
    steps_mm = np.abs(np.diff(outcome.column("Z.truth_mm")))
    assert steps_mm.max() < 0.1
