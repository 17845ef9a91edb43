"""What is foretold of a stop: by dynamics of the program, and by the motion before it."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import DEMAND, LOAD, RUN, STOP, K, recorded
from tests.recordings import Step, block_trace

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import TorqueLimit
from axisrig.kernel.time.clock import MS

FOUND = "contact of Z with its stop, found by lag"
CHOSEN = "no closed form with dynamics that the program has chosen (#SLOPE, G130 to G134)"


def block_of(observed: Observed) -> Any:
    (block,) = stop_findings(observed)
    return block


def excess_of(observed: Observed) -> Value:
    (found,) = (value for value in block_of(observed).values if value.key == "command_excess")
    assert isinstance(found, Value)
    return found


@pytest.mark.parametrize(
    ("steps", "is_chosen"),
    [
        ([], False),
        ([("feed", 2.0)], False),
        ([("dynamics", 2.0)], True),
        ([("feed", 1.0), ("dynamics", 10.0)], True),  # the run begins at 10 ms
        ([("dynamics", 10.5)], False),
        ([("dynamics", 400.0), ("feed", 2.0)], False),
        ([("dynamics", 400.0), ("dynamics", 5.0)], True),
    ],
)
def test_dynamics_that_the_program_chose_before_the_run_have_no_closed_form(
    steps: list[tuple[str, float]], is_chosen: bool
) -> None:
    of = recorded(plant={"viscous_friction": 1e5})
    rows = [Step(f"N{n} ", kind, at, at, at + 1.0) for n, (kind, at) in enumerate(steps)]
    of = Observed(replace(of.facts, blocks=block_trace(rows)), of.series)
    assert block_of(of).prediction == (CHOSEN if is_chosen else FOUND)
    excess = excess_of(of)
    assert (excess.low is None) is is_chosen
    assert (excess.note == CHOSEN) is is_chosen


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_what_is_foretold_is_of_the_motion_until_the_detection(side: float) -> None:
    """With 10 mm/s the lag is 0.18 mm; with 100 mm/s it would be above its limit of 0.5 mm.

    Neither a jump of one cycle before the detection is its feed, nor what comes after it.
    """
    after = np.where(K >= 205, (K - 205) * 0.1, 0.0)
    for beside in (after, np.where(K == 60, 3.0, 0.0), np.zeros(len(K))):
        of = recorded(side, columns={"drive_lag_mm": side * (DEMAND + beside - LOAD)})
        assert block_of(of).prediction == FOUND
    fast = np.where(K <= 203, np.clip((K - 30) * 0.1, 0.0, None), 17.3)
    of = recorded(side, columns={"drive_lag_mm": side * (fast - LOAD)})
    assert block_of(of).prediction.startswith("found in free motion: Z: ")


@pytest.mark.parametrize("detected", [True, False])
def test_a_force_limit_is_that_of_the_detection_or_of_the_end(detected: bool) -> None:
    """1000 per mille of 1 N.m are 2 pi 1/0.01 = 628 N; half of it from 250 ms on."""
    stop = STOP if detected else replace(STOP, detected_ns=None, detected_by=None)
    of = recorded(run=replace(RUN, fixed_stop=stop), plant={"force_limit_motor": None})
    limits = (TorqueLimit(0, 1000, 1000, 1000), TorqueLimit(250 * MS, 500, 1000, 1000))
    axis = replace(
        of.facts.axes["Z"], rated_torque_mnm=1000, lead_um=10_000.0, torque_limits=limits
    )
    of = Observed(replace(of.facts, axes={"Z": axis}), of.series)
    expected_n = 2.0 * math.pi * 100.0 * (1.0 if detected else 0.5)
    assert block_of(of).limits["Z"].force_limit_n == pytest.approx(expected_n)
