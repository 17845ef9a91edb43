"""An axis at the ends of a time: its first demand, and the force of a stop at begin and end."""

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu, axis_of

from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize("motor_m", [None, 0.5, -0.5])
def test_an_axis_is_to_stay_where_its_motor_is(motor_m: float | None) -> None:
    """From the start on, at rest; without a motor that is where its load is."""
    own = {} if motor_m is None else {"motor_position": motor_m}
    fmu = Fmu(*RAMP, position=0.25, velocity=1.0, **own)
    axis = PlantAxis(fmu.roles, lambda _ns: None)
    axis.start(3 * MS)
    place_m = 0.25 if motor_m is None else motor_m
    assert [fmu.inputs[name] for name in RAMP] == pytest.approx([place_m, 0.0, 0.003, 0.003])
    axis.step_to(4 * MS)
    assert axis.demand_position_m() == place_m


@pytest.mark.parametrize(
    ("since_us", "until_us", "force_n"),
    [(1000, 2000, 5.0), (0, 1000, 5.0), (1001, 2000, 0.0), (0, 999, 0.0), (1000, 1000, 5.0)],
)
def test_a_force_at_either_end_of_a_time_belongs_to_it(
    since_us: int, until_us: int, force_n: float
) -> None:
    fmu = Fmu(*RAMP, position=0.0, velocity=0.0, stop_force=lambda ns: 5.0 * (ns == MS))
    axis = axis_of(fmu)
    for end in (1, 2):
        axis.step_to(end * MS)
    assert axis.stop_force_peak_n(since_us * US, until_us * US) == pytest.approx(force_n)
