"""Metrics of the tool centre point where a program has several kinematics, or rapid traverse."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.kinematics import metrics
from axisrig.bench.judge.kinematics.metrics import KINEMATIC_METRICS
from axisrig.kernel.time.clock import MS

FIRST, LAST = (SimpleNamespace(axes=axes) for axes in (("X", "Y", "Z", "A"), ("U", "V", "W", "B")))
# Places of the tool in 8 rows: 1 mm a cycle in rapid traverse, then 0.1, down 0.2, and at rest
X_MM = np.array([0.0, 1.0, 2.0, 2.1, 2.2, 2.0, 1.8, 1.8])


def observed(monkeypatch: pytest.MonkeyPatch, *stretches: tuple[bool, int, int]) -> Any:
    found = [
        SimpleNamespace(on=FIRST, has_feed=feed, begin=begin, end=end, shift=0)
        for feed, begin, end in stretches
    ]
    monkeypatch.setattr(metrics, "stretches", lambda _: found)
    monkeypatch.setattr(metrics, "places", lambda _, on, _column, rows: (on, X_MM[rows]))

    def centre(_: Any, on: Any, axes: Any) -> Any:
        assert axes[0] is on
        offset = 100.0 if on is LAST else 0.0
        return np.stack([axes[1] + offset, axes[1] * 0 + offset, axes[1] * 0 - offset], axis=-1)

    monkeypatch.setattr(metrics, "tool_centre_mm", centre)

    class Rows:
        facts = SimpleNamespace(kinematics=(FIRST, LAST), timing=SimpleNamespace(period_ns=2 * MS))

        def __len__(self) -> int:
            return len(X_MM)

    return Rows()


@pytest.mark.parametrize(
    ("stretches", "speed_mm_s"),
    [
        ([(False, 0, 2), (True, 2, 4), (True, 4, 6)], 100.0),
        ([(True, 2, 4), (False, 0, 2)], 50.0),
        ([(False, 0, 2)], None),
        ([], None),
    ],
)
def test_a_speed_is_that_of_blocks_with_a_feed(
    stretches: list[tuple[bool, int, int]],
    speed_mm_s: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = observed(monkeypatch, *stretches)
    found = KINEMATIC_METRICS["tcp_velocity_mm_s_max"](seen, None).value
    assert found == (None if speed_mm_s is None else pytest.approx(speed_mm_s))


def test_the_place_at_the_end_is_that_of_the_last_kinematic(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of its own axes: those of the first one are none of it any more."""
    seen = observed(monkeypatch)
    values = [KINEMATIC_METRICS["tcp_mm"](seen, axis).value for axis in "UVW"]
    assert values == pytest.approx([101.8, 100.0, -100.0])
    for axis in ("X", "B", None):
        missing = KINEMATIC_METRICS["tcp_mm"](seen, axis)
        assert missing.value is None
        assert "U V W" in missing.note
