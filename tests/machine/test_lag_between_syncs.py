"""The largest lag of a drive lies between two SYNCs: witnesses at each tick of the drive."""

from typing import Any

import numpy as np
import pytest
from tests.can_parts import can_of

from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.recording.lag import largest_lag


def test_peak_of_a_parabola_between_two_rows() -> None:
    """Demand at rest, motor v t (T - t): v T^2/4 half way; ticks at T/4, T/2, 3T/4."""
    period, speed = 1e-3, 2.0
    times = np.array([0, 1_000_000, 2_000_000])
    zero = np.zeros(3)
    slope = np.array([speed * period, -speed * period, -speed * period])
    lag = largest_lag(times, (zero, zero, slope), 250_000)
    # In the second period the motor is the cubic with slope -vT at both ends: -vT t(1-t)(1-2t)
    assert lag == pytest.approx([0.0, speed * period**2 / 4, speed * period**2 * 3 / 32])


@pytest.mark.parametrize("is_before", [True, False])
def test_an_axis_that_follows_its_demand_exactly_has_no_lag_where_its_speed_changes(
    is_before: bool,
) -> None:
    """At a corner the row has the speed before it or after it: the step is straight all the same.

    One that is behind by 3 um there is so at every tick.
    """
    times = np.arange(5) * 1_000_000
    demand = np.array([0.0, 1.0, 2.0, 5.0, 8.0]) * 1e-3
    steps = np.diff(demand) / 1e-3
    speed = np.concatenate([[1.0], steps]) if is_before else np.concatenate([steps, [3.0]])
    for behind_m in (0.0, 3e-6):
        lag = largest_lag(times, (demand, demand - behind_m, speed), 250_000)
        assert lag == pytest.approx([behind_m] * 5, abs=1e-12)


def test_a_tick_longer_than_the_period_sees_the_rows_only() -> None:
    times = np.array([0, 1_000_000])
    lag = largest_lag(times, (np.array([1.0, -2.0]), np.zeros(2), np.ones(2)), 1_000_000)
    assert lag == pytest.approx([1.0, 2.0])
    assert largest_lag(times[:1], (zero := np.zeros(1), zero, zero), 250_000) == pytest.approx([0])


@pytest.mark.long
@pytest.mark.parametrize("period_us", [2000, 4000])
@pytest.mark.parametrize("window_mm", [0.71, 0.73])
def test_a_drive_that_ends_its_demand_at_a_tick_has_the_lag_of_that_tick(
    run_nc: Any, period_us: int, window_mm: float
) -> None:
    """Against a stop the lag grows by v 0.25 ms from tick to tick, until it passes the window."""
    speed_mm_s, tick_s = 20.0, 250e-6
    words = f'["0x6065:0", {round(window_mm * 104857.6)}], ["0x6066:0", 0]'
    out = run_nc(
        "N10 G1 Z133 F1200",
        f"[cycle]\nperiod_us = {period_us}\n[drive.servo]\nsdo = [{words}]",
        "plant:z.stop_position_mm=131",
        base="probe-z.toml",
    )
    assert out.facts.alarms
    peak, rows = out.column("Z.drive_lag_peak_mm"), np.abs(out.column("Z.drive_lag_mm"))
    assert window_mm < np.max(peak) <= window_mm + speed_mm_s * tick_s + 1e-6
    assert np.max(rows) < window_mm, "the rows are before and behind it"


@pytest.mark.long
@pytest.mark.interpreted
@pytest.mark.parametrize("period_us", [1000, 4000])
def test_metric_is_the_largest_lag_at_the_ticks_of_the_drive(
    run_nc: Any, monkeypatch: pytest.MonkeyPatch, period_us: int
) -> None:
    """Witness: another run of the program whose plant is looked at in each tick after a SYNC."""
    program = "N10 G1 Z110 F3000\nN20 G1 Z120 F6000"
    rig = f"[cycle]\nperiod_us = {period_us}"
    out = run_nc(program, rig, base="probe-z.toml")
    peak = out.column("Z.drive_lag_peak_mm")

    seen: list[float] = []

    def look(machine: Machine) -> None:
        axis = next(iter(machine.plant.axes.values()))
        axis.advance_to(machine.scheduler.now_ns)
        seen.append(abs(axis.motion[4] - axis.motion[2]) * 1e3)

    build = Machine.run

    def run(machine: Machine) -> Any:
        servo = can_of(machine).nodes["Z"].servo
        cycle = servo.cycle

        def witnessed(now_ns: int) -> None:
            seen.append(abs(servo.axis.motion[4] - servo.axis.motion[2]) * 1e3)
            cycle(now_ns)
            for tick in range(1, period_us // 250):
                machine.scheduler.call_at(now_ns + tick * 250_000, 1, lambda: look(machine))

        servo.cycle = witnessed  # type: ignore[method-assign]
        return build(machine)

    monkeypatch.setattr(Machine, "run", run)
    again = run_nc(program, rig, base="probe-z.toml")
    assert np.max(peak) == pytest.approx(max(seen), abs=1e-5)
    assert np.max(peak) >= np.max(np.abs(out.column("Z.drive_lag_mm")))
    # Ticks that move the plant on do not move the rows: they stay at the SYNC
    for name in ("time_ns", "Z.truth_mm", "Z.drive_lag_mm", "Z.set_mm"):
        assert again.column(name).tolist() == out.column(name).tolist(), name
