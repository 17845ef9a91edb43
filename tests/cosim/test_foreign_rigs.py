"""Whole runs on FMUs of other tools: a feed table and a switch in mm, mapped by the rig.

The table is a position loop s' = gain (s_set - s), the switch closes at a depth; both are exact, so
what the bench measures is compared with closed forms.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program

# The table tells no velocity, so an edge is known to 1/256 of a fine step of 50 us
PART_NS = pytest.approx(50e3 / 256, abs=1)
GAIN_PER_S, TICK_S = 40.0, 62.5e-6
FEED_MM_S = 500 / 60
INPUT_DELAY_S = 4e-6
INCREMENT_MM = 10 / 1_048_576

Place = Callable[..., Path]


def run(place: Path, *assignments: str) -> Machine:
    """Run the program to its end."""
    rig, files = read_rig(place / "rig.toml")
    changes = [(parse_assignment(text), as_written) for text in assignments]
    settings = read_settings(rig, files, changes)
    machine = Machine(settings, read_program(place / "part.nc", tuple(rig.axis)))
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.alarms == []
    return machine


def latched_mm(machine: Machine) -> float:
    """The measured value of the only run."""
    (record,) = machine.channel.records
    return record.latched_mm["Z"]


@pytest.mark.long
def test_edge_is_enclosed_where_the_state_can_be_saved(place: Place) -> None:
    """The switch closes at 100 mm; the drive latches 4 us later, at 500 mm/min."""
    machine = run(place())
    probe = machine.plant.probes["switch"]
    assert probe.edge_uncertainty_ns == PART_NS
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    # one increment, one nanosecond, and the demand that is held for 62.5 us: v/8 of it at most
    held_mm = FEED_MM_S * GAIN_PER_S * TICK_S * TICK_S / 8
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=INCREMENT_MM + held_mm)


@pytest.mark.long
def test_without_saved_states_a_fine_step_is_the_recorded_uncertainty(place: Place) -> None:
    machine = run(place(saves=False))
    probe = machine.plant.probes["switch"]
    fine_ns = machine.plant.fine_ns
    assert probe.edge_uncertainty_ns == fine_ns
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    uncertain_mm = FEED_MM_S * probe.edge_uncertainty_ns * 1e-9 + INCREMENT_MM
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=uncertain_mm)


FAR = ('"table.s_start_mm" = 103', '"table.s_start_mm" = 170')


def steady_motion(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Lag (mm) and velocity (mm/s) at each SYNC while the table moves steadily at -50 mm/s."""
    (folder / "part.nc").write_text("N10 G90 G1 Z120 F3000\nN20 M30\n", encoding="utf-8")
    trace = run(folder).recorder.table()
    set_mm = trace.column("Z.set_mm").to_numpy()
    steady = np.flatnonzero((set_mm < 140) & (set_mm > 125))
    lag_mm = trace.column("Z.drive_lag_mm").to_numpy()
    return lag_mm[steady], trace.column("Z.velocity_mm_s").to_numpy()[steady]


def held_lag_mm(hold_s: float) -> float:
    """Lag of a position loop whose demand is held: e = v T / (1 - exp(-gain T)).

    From s(k+1) - e = s(k) - e exp(-gain T) with s(k+1) = s(k) + v T, v = -50 mm/s.
    """
    return -50.0 * hold_s / (1 - math.exp(-GAIN_PER_S * hold_s))


@pytest.mark.long
def test_lag_is_that_of_a_demand_held_between_drive_ticks(place: Place) -> None:
    """Without the hold it were v/gain, 1.6 um less."""
    lag_mm, speed_mm_s = steady_motion(place(FAR))
    assert abs(held_lag_mm(TICK_S) + 50.0 / GAIN_PER_S) > 1.5e-3
    assert lag_mm == pytest.approx(held_lag_mm(TICK_S), abs=5e-5)
    assert speed_mm_s == pytest.approx(-50.0, abs=50.0 * GAIN_PER_S * TICK_S)


@pytest.mark.long
def test_fmu_that_takes_one_step_size_only_is_stepped_on_its_grid(
    place: Place, version: int
) -> None:
    """The demand is then held for its step of 1 ms, and the motion is smooth between its points."""
    size = "stepSize" if version == 2 else "fixedInternalStepSize"
    fixed = {"canHandleVariableCommunicationStepSize": False, size: "0.001"}
    lag_mm, speed_mm_s = steady_motion(place(FAR, table=fixed))
    assert lag_mm == pytest.approx(held_lag_mm(1e-3), abs=5e-5)
    assert speed_mm_s == pytest.approx(-50.0, abs=0.02)


@pytest.mark.long
def test_edge_on_a_table_with_a_grid_is_enclosed_as_well(place: Place) -> None:
    """Measured is the place of the edge, whatever the steps of the table are."""
    fixed = {"canHandleVariableCommunicationStepSize": False, "stepSize": "0.001"}
    machine = run(place(table=fixed))
    assert machine.plant.probes["switch"].edge_uncertainty_ns == PART_NS
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=2 * INCREMENT_MM)


@pytest.mark.long
def test_switch_with_a_grid_knows_its_edge_to_a_step(place: Place) -> None:
    fixed = {"canHandleVariableCommunicationStepSize": False, "stepSize": "0.001"}
    machine = run(place(switch=fixed))
    assert machine.plant.probes["switch"].edge_uncertainty_ns == 1e6
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=FEED_MM_S * 1e-3 + INCREMENT_MM)


@pytest.mark.long
def test_encoder_on_the_screw_and_on_the_table_latch_the_same(place: Place) -> None:
    motor = (
        'position = "table.s"\n',
        'position = "table.s"\n'
        'motor_position = { variable = "motor.phi", lead_mm = 10 }\n'
        'motor_velocity = { variable = "motor.n", lead_mm = 10 }\n',
    )
    machine = run(place(motor))
    held_mm = FEED_MM_S * GAIN_PER_S * TICK_S * TICK_S / 8
    expected_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    assert latched_mm(machine) == pytest.approx(expected_mm, abs=INCREMENT_MM + held_mm)


@pytest.mark.long
def test_inverted_switch_gives_the_falling_edge(place: Place) -> None:
    inverted = ("threshold = 12 }", "threshold = 12, sign = -1 }")
    machine = run(place(inverted), "set:Z.kenngr.measure.edge=NEG")
    ((_, level),) = machine.plant.probes["switch"].signal.edges
    assert level is False


@pytest.mark.long
def test_same_run_gives_the_same_frames(place: Place) -> None:
    folder = place()
    first, second = run(folder), run(folder)
    assert first.hexdigest() == second.hexdigest()
