"""The force between an axis and its fixed stop, as the trace gets it."""

import math
from collections.abc import Callable, Iterator

import pytest

from axisrig.bench.oracles.fixed_stop.pressing import Stop
from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.fmi.roles import map_roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import STOP_FACE, STOP_FORCE
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, US

MASS = 120 + 1.8e-4 * (2 * math.pi / 0.01) ** 2  # kg
FREE = {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0}
V_M_S = 0.043
STOP_M = 2e-3


@pytest.fixture
def make() -> Iterator[Callable[..., PlantAxis]]:
    """Make a servo axis that runs at V_M_S towards its stop, its plant at time 0."""
    plants = []

    def made(sources: dict[str, None] | None = None, **start: float) -> PlantAxis:
        slave = load_fmu(ensure_built("AxisRig.Drives.ServoAxis"), "axis")
        values = {**FREE, "kv": 40.0, "stop_position": STOP_M, "force_limit_motor": 800.0, **start}
        for name, value in values.items():
            slave.set_start(name, value)
        plant = Plant()
        plants.append(plant)
        axis = plant.add_axis(slave, map_roles(slave, "axis", sources or {}))
        plant.initialize(0)
        axis.command(0, 0.0, V_M_S, 200 * MS, enabled=True)
        return axis

    yield made
    for plant in plants:
        plant.close()


def run(axis: PlantAxis, step_ns: int, end_ns: int = 120 * MS) -> list[list[float]]:
    """The motion at each step."""
    rows = []
    for time_ns in range(step_ns, end_ns + 1, step_ns):
        axis.advance_to(time_ns)
        rows.append(axis.motion)
    return rows


def contact_n(row: list[float], stiffness: float, damping: float = 20.0) -> float:
    """Hunt and Crossley (1975): F = max(0, k p (1 + a dp/dt))."""
    return max(0.0, stiffness * (row[0] - STOP_M) * (1 + damping * row[1]))


@pytest.mark.parametrize("stiffness", [20e6, 500e6])
def test_force_belongs_to_the_instant_and_its_peak_to_the_interval(make, stiffness) -> None:
    axis = make(stop_stiffness=stiffness)
    rows = run(axis, 1 * MS)
    assert max(row[STOP_FORCE] for row in rows) > 800.0
    for row in rows:
        assert row[STOP_FORCE] == pytest.approx(contact_n(row, stiffness), rel=1e-9, abs=1e-6)
        assert row[STOP_FACE] == STOP_M
    witness = make(stop_stiffness=stiffness)
    fine = [contact_n(row, stiffness) for row in run(witness, 5 * US)]
    miss = {20e6: 5e-6, 500e6: 2e-4}[stiffness]
    for k in range(120):
        largest = max(fine[max(0, 200 * k - 1) : 200 * (k + 1)])
        found = axis.stop_force_peak_n(k * MS, (k + 1) * MS)
        assert found == pytest.approx(largest, rel=miss + 1e-5, abs=1e-6)


@pytest.mark.parametrize("step_ns", [1 * MS, 4 * MS, 20 * MS])
def test_following_a_contact_moves_nothing(make, step_ns) -> None:
    coarse = make()
    coarse.fine_ns = 100 * MS
    fine = make()
    assert run(fine, step_ns) == run(coarse, step_ns)
    assert len(coarse._times) < len(fine._times)


def test_peak_is_the_same_whatever_the_steps_are(make) -> None:
    peaks = set()
    for step_ns in (1 * MS, 4 * MS, 20 * MS):
        axis = make()
        run(axis, step_ns)
        peaks.add(axis.stop_force_peak_n(0, 120 * MS))
    assert len(peaks) == 1


@pytest.mark.parametrize(("stiffness", "damping"), [(20e6, 60.0), (20e6, 0.0), (500e6, 20.0)])
def test_peak_between_two_steps_is_off_by_no_more_than_its_bound(make, stiffness, damping) -> None:
    """Witness: the same contact in steps of 5 us, which is off by 1e-5 of the bound."""
    stop = Stop(1, stiffness, damping_s_m=damping)
    peaks = []
    for fine_ns in (50 * US, 5 * US):
        axis = make(stop_stiffness=stiffness, stop_damping=damping)
        axis.fine_ns = fine_ns
        run(axis, 10 * MS, 80 * MS)
        peaks.append(axis.stop_force_peak_n(0, 80 * MS))
    # Other steps of the integration may move a position by 0.1 nm
    bound_n = stop.summit_doubt_n(peaks[1], MASS, 50e-6) + stop.doubt_n(peaks[1], 1e-7)
    assert bound_n < 1e-4 * peaks[1]
    assert peaks[0] == pytest.approx(peaks[1], abs=bound_n)


def test_no_contact_no_fine_steps(make) -> None:
    axis = make(stop_position=1.0)
    run(axis, 1 * MS)
    assert len(axis._times) == 121
    assert axis.stop_force_peak_n(0, 120 * MS) == 0.0


def test_a_stop_that_does_not_tell_its_place_is_followed_from_its_force_on(make) -> None:
    axis = make({"stop_face": None})
    rows = run(axis, 1 * MS)
    touched = next(k for k, row in enumerate(rows, 1) if row[STOP_FORCE] > 0)
    assert axis.stop_force_peak_n(0, touched * MS) == rows[touched - 1][STOP_FORCE]
    assert axis.stop_force_peak_n(0, 120 * MS) > max(row[STOP_FORCE] for row in rows)


def test_an_axis_without_these_outputs_has_none(make) -> None:
    axis = make({"stop_face": None, "stop_force": None, "force": None})
    run(axis, 1 * MS)
    assert axis.motion[5:] == [0.0, 0.0, 0.0]
    assert axis.force_n() is None


def test_a_stop_that_comes_to_an_axis_at_rest_pushes_it(make) -> None:
    """It meets the axis at STOP_M after 0.1 s at 20 mm/s; the drive holds against it."""
    begin, speed = 0.01, -0.02
    far = STOP_M - speed * 0.1
    axis = make(stop_position=far, stop_speed=speed, stop_begin=begin, stop_end=begin + 0.15)
    axis.command(0, STOP_M, 0.0, 0, enabled=True)
    rows = run(axis, 1 * MS, 200 * MS)
    for k, row in enumerate(rows, 1):
        face = far + speed * min(max(k * 1e-3 - begin, 0.0), 0.15)
        assert row[STOP_FACE] == pytest.approx(face, abs=1e-12)
        approach = row[1] - (speed if 0.01 < k * 1e-3 <= 0.16 else 0.0)
        if k != 160:  # its velocity steps
            force = max(0.0, 20e6 * (row[0] - face) * (1 + 20 * approach))
            assert row[STOP_FORCE] == pytest.approx(force, rel=1e-9, abs=1e-6)
    assert rows[105][STOP_FORCE] == 0.0
    assert rows[-1][STOP_FORCE] > 100.0


@pytest.mark.parametrize("speed_m_s", [0.5, 1.0])
@pytest.mark.parametrize("step_ns", [1 * MS, 2 * MS, 20 * MS])
def test_a_fast_stop_meets_a_resting_axis_as_in_fine_steps(make, speed_m_s, step_ns) -> None:
    """It comes from 20 mm: contact to a fine step, peak of the force as in steps of 5 us."""
    begin_s = 0.0108  # the contact lies inside a ms
    moving = {
        "stop_position": 0.02, "stop_speed": -speed_m_s, "stop_begin": begin_s, "stop_end": 1.0,
        "stop_stiffness": 200e6, "stop_damping": 0.0,
    }  # fmt: skip
    met_ns = round((begin_s + 0.02 / speed_m_s) * 1e9)
    end_ns = met_ns // (20 * MS) * 20 * MS + 20 * MS
    axes = make(**moving), make(**moving)
    for axis in axes:
        axis.command(0, 0.0, 0.0, 0, enabled=True)
        axis.advance_to(end_ns - 20 * MS)
    axis, witness = axes
    run_from(axis, step_ns, end_ns)
    fine = run_from(witness, 5 * US, end_ns)
    touched = next(time_ns for time_ns, row in fine if row[STOP_FORCE] > 0.0)
    assert abs(touched - met_ns) <= 10 * US, "the axis rests until then"
    before, after = touched - 50 * US, touched + 50 * US
    assert axis.stop_force_peak_n(0, before) == 0.0
    assert axis.stop_force_peak_n(before + 1, after) > 0.0, "a step ends just behind the contact"
    largest = max(row[STOP_FORCE] for _, row in fine)
    assert largest == pytest.approx(speed_m_s * math.sqrt(200e6 * MASS), rel=0.02)
    assert axis.stop_force_peak_n(0, end_ns) == pytest.approx(largest, rel=2e-4)


def run_from(axis: PlantAxis, step_ns: int, end_ns: int) -> list[tuple[int, list[float]]]:
    """The motion at each step from where the axis is."""
    rows = []
    for time_ns in range(axis.slave.time_ns + step_ns, end_ns + 1, step_ns):
        axis.advance_to(time_ns)
        rows.append((time_ns, axis.motion))
    return rows
