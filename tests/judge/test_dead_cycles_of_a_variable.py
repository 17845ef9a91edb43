"""Dead cycles of an axis whose sensor is a variable of the PLC: no frame carries it.

Recordings made of formulas (`controls.py`): 1 ms, on from row 100 on. The value steps in row 400,
the set position in the frame of the cycle after, and the value shows that two cycles later.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import CLAMP, ON, K, recorded

from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, FREEZE, DistanceTruth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.cycles import Measured, NotMeasurableError
from axisrig.bench.record.distance import DistanceChange, PlcSensor
from axisrig.bench.record.series import SECOND, TARGET, Telegrams
from axisrig.kernel.time.clock import MS, US

STEP = 400
FRAME_NS = 700 * US
"""End of the frame of a set position in its cycle."""


class Framed(Observed):
    """A recording with the frames of Z: the set position, and a 60E4 that is not read."""

    target: Any = None

    def telegrams(self, axis: str, field: str) -> Iterator[Telegrams]:
        assert axis == "Z"
        frames = {TARGET: self.target, SECOND: np.where(K >= 777, 99, 0)}
        yield Telegrams(K * MS + FRAME_NS, frames[field])


def answered(
    size_mm: float,
    reaction: int,
    way: int,
    state: int = ACTIVE_CONST_DIST,
    early: Any = 0.0,
    base_mm: float = -2.0,
) -> DistanceTruth:
    """early: of the value, in each row before the step."""
    sensor = np.where(K >= STEP, size_mm, 0.0) + early * (K < STEP - 50)
    sensor = np.where(STEP + reaction + way <= K, 0.0, sensor) + base_mm
    change = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "VARIABLE V.E.GAP", False,
                            CLAMP)  # fmt: skip
    made = recorded(columns={"sensor_mm": sensor}, changes=(change,), state=state)
    facts = replace(made.facts, plc_sensors={"V.E.GAP": PlcSensor("gap", -1, 0)})
    observed = Framed(facts, made.series)
    observed.target = np.where(STEP + reaction <= K, 500 if size_mm > 0 else -500, 0)
    found = distance_truth(observed, "Z")
    assert found is not None
    return found


def cycles(found: Measured) -> tuple[int, int]:
    return found.cycles.reaction, found.cycles.way


@pytest.mark.parametrize(("reaction", "way"), [(0, 2), (1, 2), (3, 4)])
@pytest.mark.parametrize("size_mm", [1.5, -1.5, 0.0005])
@pytest.mark.parametrize("state", [ACTIVE, ACTIVE_CONST_DIST])
def test_the_value_that_the_control_has_read_shows_the_step_and_its_answer(
    reaction: int, way: int, size_mm: float, state: int
) -> None:
    """In 0.1 um, of the SYNC of its row; the set position in its frame."""
    found = answered(size_mm, reaction, way, state).measured_dead()
    assert cycles(found) == (reaction, way)
    assert (found.seen_ns, found.sent_ns, found.shown_ns) == (
        STEP * MS, (STEP + reaction) * MS + FRAME_NS, (STEP + reaction + way) * MS,
    )  # fmt: skip


@pytest.mark.parametrize("before", [1.0, np.nan])
def test_what_the_value_did_before_the_control_was_on_is_no_step(before: float) -> None:
    """Another value up to row 60, or none at all."""
    found = answered(1.5, 1, 2, early=np.where(K < 60, before, 0.0)).measured_dead()
    assert cycles(found) == (1, 2)


def test_a_value_that_comes_late_counts_as_0_until_then() -> None:
    """From there to -2 mm is a step without an answer, to 0 none."""
    none = np.where((K > ON - 10) & (K < ON + 30), np.nan, 0.0)
    with pytest.raises(NotMeasurableError, match="went on changing"):
        answered(1.5, 1, 2, early=none).measured_dead()
    assert cycles(answered(1.5, 1, 2, early=none, base_mm=0.0).measured_dead()) == (1, 2)


def test_noise_that_is_named_is_no_step() -> None:
    """2 um around row 250, and a step of 1.5 mm: 20 increments are none."""
    noisy = answered(1.5, 1, 2, early=np.where(K == 250, 0.002, 0.0))
    assert cycles(noisy.measured_dead(quiet_increments=20)) == (1, 2)
    with pytest.raises(NotMeasurableError):
        noisy.measured_dead(quiet_increments=19)


def test_a_control_that_never_followed_has_no_step() -> None:
    with pytest.raises(NotMeasurableError, match="never changed"):
        answered(1.5, 1, 2, state=FREEZE).measured_dead()
