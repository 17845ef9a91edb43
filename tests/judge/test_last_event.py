"""What moved a loop last, the time that another law divides, and sines in a signal."""

from typing import Any

import numpy as np
import pytest
from tests.judge.controls import (
    ROWS,
    SET_DIST_MM,
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.distance.control_stretches import _last_event, last_active, sine_parts
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, FREEZE
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS


def up(*times: tuple[int, int]) -> Any:
    """A flag that is up in rows begin to end - 1."""
    return np.sum([(begin <= K) & (end > K) for begin, end in times], axis=0).astype(float)


MOVED = np.where(K >= 400, 0.5, 0.0)
TWICE = np.where(K >= 250, 0.5, 0.0) + np.where(K >= 600, 0.25, 0.0)
BACK = np.where((K >= 250) & (K < 600), 0.5, 0.0)
DISTANCE = {"set_dist_mm": SET_DIST_MM + MOVED}
PLACE = {"set_pos_mm": -SET_DIST_MM - MOVED}
LED = {"set_mm": MOVED}
EVENTS: dict[str, tuple[dict[str, Any], int]] = {
    "nothing but the begin": ({}, 100),
    "a surface that jumps": ({"surface_mm": MOVED}, 400),
    "its own distance": ({"columns": DISTANCE}, 400),
    "the place of the other mode is none": ({"columns": PLACE}, 100),
    "the program in a distance": ({"columns": LED}, 400),
    "the second jump of a surface": ({"surface_mm": TWICE}, 600),
    "a surface that jumps back": ({"surface_mm": BACK}, 600),
    "the second distance": ({"columns": {"set_dist_mm": SET_DIST_MM + TWICE}}, 600),
    "the first distance again": ({"columns": {"set_dist_mm": SET_DIST_MM + BACK}}, 600),
    "the second way of the program": ({"columns": {"set_mm": TWICE}}, 600),
    "the program back again": ({"columns": {"set_mm": BACK}}, 600),
    "the end of a hold": ({"columns": {"distance_held": up((300, 450))}}, 450),
    "of the last of two holds": ({"columns": {"distance_held": up((200, 300), (500, 520))}}, 520),
    "of one that was there before": ({"columns": {"distance_held": up((50, 130))}}, 130),
    "one that was over before is none": ({"columns": {"distance_held": up((50, 90))}}, 100),
    "one that lasts": ({"columns": {"distance_held": up((800, ROWS))}}, ROWS),
    "a hold and then the surface": (
        {"surface_mm": MOVED, "columns": {"distance_held": up((200, 300))}}, 400,
    ),
    "the surface in a hold": (
        {"surface_mm": MOVED, "columns": {"distance_held": up((380, 430))}}, 430,
    ),
}  # fmt: skip
IN_SET_POS: dict[str, tuple[dict[str, Any], int]] = {
    "its own place": ({"columns": PLACE}, 400),
    "the second place": ({"columns": {"set_pos_mm": -SET_DIST_MM - TWICE}}, 600),
    "the first place again": ({"columns": {"set_pos_mm": -SET_DIST_MM - BACK}}, 600),
    "the distance of the other mode is none": ({"columns": DISTANCE}, 100),
    "the program is none": ({"columns": LED}, 100),
    "the program with an older sensor value": ({"columns": LED, "second_delay_cycles": 1}, 400),
    "the end of a hold": ({"columns": {"distance_held": up((300, 450))}}, 450),
}


def event(**of: Any) -> int:
    truth = distance_truth(recorded(**of), "Z")
    assert truth is not None
    return _last_event(truth, last_active(truth))


def test_the_last_event_is_what_has_moved_the_loop_last() -> None:
    found = {name: event(**of) for name, (of, _) in EVENTS.items()}
    assert found == {name: row for name, (_, row) in EVENTS.items()}
    with_pos: dict[str, Any] = {"state": ACTIVE, "orders": (WITH_SET_POS,)}
    found = {name: event(**with_pos, **of) for name, (of, _) in IN_SET_POS.items()}
    assert found == {name: row for name, (_, row) in IN_SET_POS.items()}


def test_a_hold_after_the_control_is_no_event_of_it() -> None:
    state = np.where(K < 100, 0, np.where(K < 600, 4, FREEZE)).astype(float)
    columns = {"distance_state": state, "distance_held": up((700, 720))}
    assert event(columns=columns) == 100
    columns["distance_held"] = up((580, 720))
    assert event(columns=columns) == 600


@pytest.mark.parametrize("factor", [0.9, 1.01])
def test_growth_is_of_the_steps_after_a_hold(factor: float) -> None:
    """In the hold nothing moves, and before it the steps went another way."""
    free = 1e-3 * factor ** np.maximum(K - 500.0, 0.0)
    step = np.where(K >= 500, free, np.where(K < 300, 0.01 * 0.99 ** (K - 100.0), 0.0)) * (K > 100)
    columns = {"distance_held": up((300, 500)), "step_mm": step, "delta_mm": step}
    found = seen(recorded(columns=columns), "distance_growth")
    assert found.value == pytest.approx(factor, abs=1e-6)
    word = "stable" if factor < 1 else "unstable"
    assert seen(recorded(columns=columns), "distance_stability").value == word


# A law that a word changes while the control is on

LATER = DistanceOrder(500 * MS, "NC", words={"kp": 0.3})


@pytest.mark.parametrize("orders", [(WITH_CONST_DIST,), (WITH_CONST_DIST, LATER)])
def test_settling_and_overshoot_are_of_the_whole_time_with_the_control_on(orders: Any) -> None:
    """1 mm at 200, past by 0.25 mm from 210 on; 0.5 mm at 700, past by 0.05 mm, until 730."""
    behind = np.select(
        [K < 200, K < 210, K < 220, K < 700, K < 715, K < 730],
        [0.0, 1.0, -0.25, 0.0, 0.5, -0.05],
        0.0,
    )
    of = recorded(behind, orders=orders)
    assert seen(of, "distance_settling_ms").value == pytest.approx(530.0)
    assert seen(of, "distance_overshoot_mm").value == pytest.approx(0.25)
    early = recorded(np.where(K < 220, behind, 0.0), orders=orders)
    assert seen(early, "distance_settling_ms").value == pytest.approx(20.0)
    assert seen(early, "distance_overshoot_mm").value == pytest.approx(0.25)
    assert seen(early, "distance_behind_um_max").value == pytest.approx(1000.0)


# Sines


def test_a_sine_has_its_frequency_mean_and_complex_amplitude() -> None:
    """mean + |a| cos(2 pi f t + arg a), also of a part of a period at the end.

    A crossing between two values is taken from a straight line: with w T = x it is off by up to
    0.016 x² of T. Over 394 ms of 33 Hz that is 3.5e-6 of the frequency, every 2 ms 2.8e-5, and as
    much of 2 pi f times the middle of the values, 44 rad, in the phase.
    """
    for frequency, mean, size, turn in ((10.0, 5.0, 2.0, 0.7), (33.0, -1.0, 0.25, -2.0)):
        time_s = np.arange(430) * 1e-3
        values = mean + size * np.cos(2 * np.pi * frequency * time_s + turn)
        for every, share in ((1, 3.5e-6), (2, 2.8e-5)):
            found = sine_parts(values[::every], every * 1e-3)
            assert found[0] == pytest.approx(frequency, rel=share)
            assert found[1] == pytest.approx(mean, abs=share * size)
            assert abs(found[2]) == pytest.approx(size, rel=share)
            assert np.angle(found[2]) == pytest.approx(turn, abs=44.0 * share)
    for values in (np.zeros(100), np.cos(2 * np.pi * 4.0 * np.arange(430) * 1e-3)):
        with pytest.raises(NoClosedFormError, match="fewer than two periods"):
            sine_parts(values, 1e-3)
