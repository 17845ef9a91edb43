"""A step of distance control is judged alike towards the workpiece and away from it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance import metrics
from axisrig.bench.judge.distance.metrics import (
    distance_behind_end_um,
    distance_overshoot_mm,
    distance_settling_ms,
)
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.kernel.time.clock import MS

# A wave before the step; the largest error, and what is left of it cycle by cycle
BEHIND_MM = [0.2, -0.3, 2.0, 1.0, 0.4, -0.1, -0.03, 0.019, -0.004, 0.006]


def truth(values: list[float], monkeypatch: pytest.MonkeyPatch) -> Any:
    part = SimpleNamespace(begin=0, end=len(values))
    monkeypatch.setattr(metrics.control_stretches, "last_on", lambda _: [part])
    monkeypatch.setattr(metrics.control_stretches, "last_active", lambda _: part)
    signal = np.array(values)
    some = SimpleNamespace(behind_mm=signal)
    return SimpleNamespace(
        has_surface=True,
        period_ns=2 * MS,
        increment_mm=1e-3,
        gathered=lambda made, rows: made(some)[rows],
    )


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_settling_overshoot_and_end_are_those_of_the_other_direction(
    sign: int, scale: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From row 2 on. Settled to 1 % of 2 mm in row 7, to 5 um of a tenth of it in row 6."""
    seen = truth([sign * scale * value for value in BEHIND_MM], monkeypatch)
    rows = 5 if scale == 1.0 else 4
    assert distance_settling_ms(seen).value == rows * 2.0
    assert distance_overshoot_mm(seen).value == pytest.approx(0.1 * scale)
    assert distance_behind_end_um(seen).value == pytest.approx(sign * 6.0 * scale)


@pytest.mark.parametrize("sign", [1, -1])
def test_what_does_not_settle_has_no_time(sign: int, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = truth([sign * value for value in (0.0, 1.0, 0.0, 0.0, -0.1)], monkeypatch)
    with pytest.raises(NoClosedFormError, match="not settled to 10 um"):
        distance_settling_ms(seen)
    quiet = truth([sign * value for value in (0.0, 1.0, 0.5, 0.2, 0.0)], monkeypatch)
    assert distance_overshoot_mm(quiet).value == 0.0
