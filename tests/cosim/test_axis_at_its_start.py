"""The first demand of an axis, and forces of a stop at the border of the time that is asked for."""

import pytest
from tests.cosim.test_edges_of_a_probe import Locating, probe_of
from tests.cosim.test_plant_by_hand import RAMP, Fmu, axis_of

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize("motor", [None, 0.5, -0.5])
def test_an_axis_is_to_stay_where_its_motor_is(motor: float | None) -> None:
    """From the start on, at rest; without a motor that is where its load is."""
    own = {} if motor is None else {"motor_position": motor}
    fmu = Fmu(*RAMP, position=0.25, velocity=1.0, **own)
    axis = PlantAxis(fmu.roles, lambda _ns: None)
    axis.start(3 * MS)
    place = 0.25 if motor is None else motor
    assert [fmu.inputs[name] for name in RAMP] == pytest.approx([place, 0.0, 0.003, 0.003])
    axis.step_to(4 * MS)
    assert axis.demand_position_m() == place


@pytest.mark.parametrize(
    ("since_us", "until_us", "force"),
    [(1000, 2000, 5.0), (0, 1000, 5.0), (1001, 2000, 0.0), (0, 999, 0.0), (1000, 1000, 5.0)],
)
def test_a_force_at_either_end_of_a_time_belongs_to_it(
    since_us: int, until_us: int, force: float
) -> None:
    fmu = Fmu(*RAMP, position=0.0, velocity=0.0, stop_force=lambda ns: 5.0 * (ns == MS))
    axis = axis_of(fmu)
    for end in (1, 2):
        axis.step_to(end * MS)
    assert axis.stop_force_peak_n(since_us * US, until_us * US) == pytest.approx(force)


@pytest.mark.parametrize(
    ("up", "down", "touched"),
    [((20, 40), (), ()), ((), (20, 40), ()), ((50,), (), (20, 40))],
)
def test_two_of_any_kind_in_a_step_are_not_both_known(
    up: tuple[int, ...], down: tuple[int, ...], touched: tuple[int, ...]
) -> None:
    """Rising edges, falling ones, and contacts."""
    probe = probe_of(Locating(up, down, touched=touched))
    assert probe.step(0, 100 * US) == 2
    with pytest.raises(PlantError, match="2 edges of one direction inside one step"):
        probe.accept(100 * US)
