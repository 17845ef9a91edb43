"""How long an axis remembers its motion: a second, as far as that is 4096 steps."""

from collections.abc import Iterator

import pytest

from axisrig.fmus.build import ensure_built
from axisrig.kernel.cosim.fmi.fmu import PlantError, load_fmu
from axisrig.kernel.cosim.fmi.roles import map_roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import HISTORY_NS, HISTORY_STEPS
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, US


@pytest.fixture
def plant() -> Iterator[Plant]:
    made = Plant()
    yield made
    made.close()


@pytest.fixture
def axis(plant: Plant) -> PlantAxis:
    axis = plant.add_axis(load_fmu(ensure_built("AxisRig.Drives.ServoAxis"), "x"))
    begin(plant, axis)
    return axis


def begin(plant: Plant, axis: PlantAxis) -> None:
    plant.initialize(0)
    axis.command(0, 0.0, 0.01, HISTORY_NS * 2, True)


@pytest.mark.parametrize("is_in_rows", [False, True])
def test_what_is_older_than_a_second_is_forgotten(axis: PlantAxis, is_in_rows: bool) -> None:
    ends_ns = range(MS, HISTORY_NS + 500 * MS + 1, MS)
    seen = {0: axis.motion}
    for first in range(0, len(ends_ns), 4):
        some = ends_ns[first : first + 4]
        if is_in_rows:
            axis.walk(some)
            seen |= zip(some, axis.walked[1:], strict=True)
        else:
            for end_ns in some:
                axis.step_to(end_ns)
                seen[end_ns] = axis.motion
    oldest_ns = ends_ns[-1] - HISTORY_NS
    for time_ns in range(oldest_ns, ends_ns[-1] + 1, 50 * MS):
        assert axis.motion_at(time_ns) == seen[time_ns]
    assert axis.motor_position_m_at(oldest_ns) == seen[oldest_ns][2]
    for time_ns in (oldest_ns - MS, 0):
        with pytest.raises(PlantError, match="no step ended at this instant"):
            axis.motion_at(time_ns)
        with pytest.raises(PlantError, match="no motion is recorded for this instant"):
            axis.motor_position_m_at(time_ns)


def test_of_short_steps_so_many_are_kept(axis: PlantAxis) -> None:
    last_ns = (HISTORY_STEPS + 100) * 50 * US
    for end_ns in range(50 * US, last_ns + 1, 50 * US):
        axis.step_to(end_ns)
    oldest_ns = last_ns - (HISTORY_STEPS - 1) * 50 * US
    assert oldest_ns > last_ns - HISTORY_NS
    axis.motion_at(oldest_ns)
    with pytest.raises(PlantError, match="no step ended at this instant"):
        axis.motion_at(oldest_ns - 50 * US)


@pytest.mark.parametrize("error_m", [12e-6, 0.0, -3e-6])
def test_what_the_second_encoder_saw_has_its_own_error(plant: Plant, error_m: float) -> None:
    """It reads the load and is off by its own error, not by that of the motor encoder."""

    def second_m() -> float:
        return axis.position_m() + error_m

    slave = load_fmu(ensure_built("AxisRig.Drives.ScrewAxis"), "x")  # its motor and load differ
    axis = PlantAxis(map_roles(slave, "axis", {}), plant.advance_to, second_encoder=second_m)
    plant.axes["x"] = axis
    begin(plant, axis)
    places = {}
    for end_ns in range(MS, 40 * MS + 1, MS):
        axis.step_to(end_ns)
        places[end_ns] = axis.position_m()
    assert places[40 * MS] - places[20 * MS] > 20e-6
    assert abs(axis.motor_position_m() - axis.position_m()) > 0.1e-6
    for time_ns in (20 * MS, 39 * MS, 40 * MS):
        seen_m = axis.second_encoder_m_at(time_ns)
        assert seen_m == pytest.approx(places[time_ns] + error_m, abs=1e-12)
    assert axis.second_encoder_m() == pytest.approx(places[40 * MS] + error_m, abs=1e-12)
