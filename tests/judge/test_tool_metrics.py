"""Metrics of the tool centre point where a program has several kinematics, or rapid traverse."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance import tool_metrics
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


@pytest.mark.parametrize(
    ("until_ms", "offset_mm", "expected"),
    [
        (None, [1.0] * 6, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        (6, [1.0] * 6, [1.0, 2.0, 3.0, 3.0, 3.0, 3.0]),  # goes in the very cycle of row 3
        (5, [1.0] * 6, [1.0, 2.0, 3.0, 3.0, 3.0, 3.0]),  # between two rows
        (6, [1.0, 1.0, 2.0, 1.0, 0.5, 0.0], [1.0, 2.0, 6.0, 3.0, 1.5, 0.0]),  # it runs out
        (6, [1.0, 1.0, 0.0, 1.0, 1.0, 1.0], [1.0, 2.0, 0.0, 0.0, 0.0, 0.0]),
        (0, [1.0] * 6, [0.0] * 6),  # there was no way before
    ],
)
def test_what_is_superposed_turns_as_long_as_its_kinematic_is_on(
    until_ms: int | None,
    offset_mm: list[float],
    expected: list[float],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The base goes 1, 2 .. 6 mm in cycles of 2 ms; this way moves the axis by base times offset.

    From the cycle in which the kinematic goes, the axis keeps what it had in the one before, and
    what runs out then does so by its share.
    """
    base = np.arange(1.0, 7.0)[:, None]
    way = SimpleNamespace(
        until_ns=None if until_ms is None else until_ms * MS,
        superposed=lambda poses, offsets: poses + poses * np.asarray(offsets)[:, None],
    )
    truth: Any = SimpleNamespace(
        listed=SimpleNamespace(is_optimized=True),
        is_active=np.ones(6, dtype=bool),
        base=base,
        times_ns=np.arange(6) * 2 * MS,
        way_rows=lambda: [(way, slice(0, 6))],
    )
    walked = SimpleNamespace(offset_mm=np.array(offset_mm))
    monkeypatch.setattr(tool_metrics.expected_offset, "walk", lambda _: walked)

    class Truth(SimpleNamespace):
        def __getitem__(self, name: str) -> Any:
            return walked.offset_mm

    found = tool_metrics._expected_superposed(Truth(**vars(truth)))  # type: ignore[arg-type]
    assert found[:, 0].tolist() == pytest.approx(expected)
