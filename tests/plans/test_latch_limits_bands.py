"""Limits of testplans/latch_limits.csv from closed forms; nothing of the bench is imported.

What a latch in the drive costs on a screw with backlash, in a braking ramp, with pulses that are
shorter than its input wants, and with a latch that an earlier run has left. Lengths in um, v in
mm/s, times in ms.
"""

import csv
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
Q_UM = 10_000.0 / 2**20  # an increment: lead 10 mm, 20 bits
INPUT_MS = 0.004

with (PLANS / "latch_limits.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def _rig(row: dict[str, str]) -> dict[str, Any]:
    return tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))


def _band(row: dict[str, str]) -> tuple[float, float]:
    middle, width = (float(part) for part in row["check:latch_error_um"].split(" +- "))
    return middle, width


def _feed(row: dict[str, str]) -> float:
    return float(row["plc:V.E.FEED"]) / 60.0


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_every_rig_has_this_encoder_and_this_input(row: dict[str, str]) -> None:
    servo = _rig(row)["drive"]["servo"]
    assert servo["lead_mm"] * 1000 / servo["encoder_increments"] == Q_UM
    assert servo["input_delay_us"] == INPUT_MS * 1000


@pytest.mark.parametrize(("case", "sign"), [("backlash-down", -1.0), ("backlash-up", 1.0)])
def test_backlash_is_in_the_direction_and_not_in_the_repetition(case: str, sign: float) -> None:
    """b/2 + F/k + v t, F of LuGre friction in steady sliding and k = 120 N/um: the motor is ahead.

    The defaults of the model: 120 N Coulomb, 160 N breakaway at 5 mm/s, 0.8 N s/mm.
    """
    row = ROWS[case]
    v, backlash = _feed(row), _rig(row)["plant"]["z"]["start"]["backlash_um"]
    assert backlash == 10
    twist = (120 + 40 * math.exp(-((v / 5.0) ** 2)) + 0.8 * v) / 120.0
    middle, width = _band(row)
    assert middle == pytest.approx(sign * (backlash / 2 + twist + v * INPUT_MS), abs=5e-5)
    assert width == 0.0095
    assert row["check:range(latch_error_um)"] == "<= 0.0095"
    assert row["check:count(latch_error_um)"] == f"== {row['plc:V.E.TOUCHES']}"
    assert float(row["check:contact_velocity_mm_s"].split(" +- ")[0]) == sign * v


def _ramp(row: dict[str, str]) -> tuple[float, float, float]:
    """Speed at the contact, deceleration and 1/Kv; from the way that is left.

    A demand that brakes with a to its end, and a loop that follows with 1/Kv: r = a(x²/2 + x/Kv +
    1/Kv²) are left x before the end of the demand, at a(x + 1/Kv).
    """
    a, lag_s = 1000.0, 1.0 / _rig(row)["plant"]["z"]["start"]["kv"]
    assert row["plant:z.feed_forward"] == "0"
    left_mm = 100.0 - float(row["plc:V.E.TO"])
    speed = math.sqrt(2 * a * left_mm - (a * lag_s) ** 2)
    # The ramp has lasted so long that the loop has the deceleration of its demand
    assert math.exp(-((_feed(row) - speed) / a) / lag_s) < 1e-3
    return speed, a, lag_s


def test_the_drive_is_exact_in_a_ramp() -> None:
    speed, _, _ = _ramp(ROWS["ramp"])
    middle, width = _band(ROWS["ramp"])
    assert middle == pytest.approx(-speed * INPUT_MS, abs=5e-5)
    assert width == 0.0095


def test_in_a_ramp_half_a_t_squared_of_the_dead_time_is_left() -> None:
    """Over the dead time t: v t at the edge is given back, of v t + a t²/2.

    The input of the drive takes its own time d after it, in which the speed is v: v d and, since it
    is slower by a d when it is latched, a t d less is given back. Each of three positions is
    rounded to half an increment: 2 t/T increments, and one of the value.
    """
    row = ROWS["ramp-dead-time"]
    speed, a, _ = _ramp(row)
    t = float(row["plant:probe.trigger_delay_us"]) / 1000
    assert t == float(row["set:Z.kenngr.probe_actuation_time_delay"]) / 1000 == 10
    a_ms = a / 1000.0  # um/ms²
    at_edge = speed - a_ms * t
    left = a_ms * t * t / 2 + at_edge * INPUT_MS + a_ms * t * INPUT_MS
    middle, width = _band(row)
    assert a_ms * t * t / 2 == 50.0
    assert middle == pytest.approx(-left, abs=1e-3)
    assert width == pytest.approx(Q_UM * (1 + 2 * t / 1.0), abs=1e-4)


def test_a_pulse_is_latched_when_it_is_longer_than_the_input_wants() -> None:
    """One opening within the time of the bounce: open from a half to the whole of it."""
    for case in ("pulse-long", "pulse-short", "pulse-filter"):
        row = ROWS[case]
        assert row["plant:probe.bounce_count"] == "1"
        pulse_us = float(row["plant:probe.bounce_time_ms"]) * 1000 / 2
        wanted_us = float(row["drive:servo.min_pulse_us"] or row["drive:servo.input_filter_us"])
        is_latched = pulse_us >= wanted_us
        assert is_latched is (case == "pulse-long")
        assert row["check:msg:N30"] == f"== {int(is_latched)}"
        assert bool(row["check:latch_error_um"]) is is_latched
        # 60FD would report that the edge that is wanted has been there before the run
        assert (row["set:Z.kenngr.measure.edge"], row["drive:servo.lacks"]) == ("NEG", "60FD")
    row = ROWS["pulse-long"]
    late_ms = float(row["plant:probe.bounce_time_ms"]) / 2 + INPUT_MS
    assert _band(row) == (pytest.approx(-_feed(row) * late_ms), 0.0095)


def test_a_latch_of_before_is_waited_for_and_never_returned() -> None:
    """The second touch has 50 um more of pre-travel: the value of the first has no range."""
    row, stays = ROWS["stale-bit"], ROWS["stale-bit-stays"]
    drift = float(row["plant:probe.drift_um"])
    assert _band(row) == (pytest.approx(-drift - _feed(row) * INPUT_MS), 0.0095)
    middle, width = (float(t) for t in row["check:range(latch_error_um)"].split(" +- "))
    assert (middle, width) == (drift, pytest.approx(2 * Q_UM, abs=1e-4))
    assert row["fault:alter"].removesuffix(" for=10ms") == stays["fault:alter"]
    assert stays["check:alarms"] == "== 900009"
    assert stays["check:latch_error_um"] == ""
