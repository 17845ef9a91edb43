"""What the second encoder of a drive reads in a plant: a load, a distance sensor, or nothing."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.grid import GridAxis
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS


def axis_fmu(name: str, position: float = 0.0, *, grid_ns: int | None = None) -> Any:
    inputs = RAMP if grid_ns is None else ("demand",)
    fmu: Any = Fmu(*inputs, grid_ns=grid_ns, position=position, velocity=0.0)
    fmu.name = name
    fmu.can = SimpleNamespace(can_save_state=True, fixed_step_s=None)
    return fmu


@pytest.mark.parametrize("grid_ns", [None, MS])
@pytest.mark.parametrize("reads", [None, "own", "other", "scale"])
def test_a_second_encoder_reads_the_load_of_an_axis_or_a_sensor(
    reads: str | None, grid_ns: int | None
) -> None:
    """Of an axis with any steps and of one on a grid; what it reads may be added later."""
    plant = Plant()
    own = axis_fmu("own", 0.25, grid_ns=grid_ns)
    axis = plant.add_axis(own, own.roles, reads)
    assert isinstance(axis, GridAxis) is (grid_ns is not None)
    other = axis_fmu("other", 0.5)
    plant.add_axis(other, other.roles)
    for each in plant.axes.values():
        each.start(0)
    sensor: Any = SimpleNamespace(distance_m=0.75)
    plant.distances["scale"] = sensor
    places = {None: None, "own": 0.25, "other": 0.5, "scale": 0.75}
    assert axis.second_encoder_m() == places[reads]
    assert plant.axes["other"].second_encoder_m() is None
    sensor.distance_m = 0.875
    assert axis.second_encoder_m() == (0.875 if reads == "scale" else places[reads])


@pytest.mark.parametrize("reads", [None, "first", "slave", "scale"])
def test_an_axis_beside_another_has_its_own_name_and_second_encoder(reads: str | None) -> None:
    plant = Plant()
    fmu = axis_fmu("first", 0.25)
    first = plant.add_axis(fmu, fmu.roles, "scale")
    part = axis_fmu("first", 0.5)
    slave = plant.add_axis_beside("slave", "first", part.roles, reads)
    sensor: Any = SimpleNamespace(distance_m=0.75)
    plant.distances["scale"] = sensor
    for each in plant.axes.values():
        each.start(0)
    assert list(plant.axes) == ["first", "slave"]
    assert (first.name, slave.name) == ("first", "slave")
    assert first.second_encoder_m() == 0.75
    places = {None: None, "first": 0.25, "slave": 0.5, "scale": 0.75}
    assert slave.second_encoder_m() == places[reads]
    for axis, name in ((first, "first"), (slave, "slave")):  # errors too name the axis
        with pytest.raises(PlantError, match=f"plant {name}.*no step ended at this instant"):
            axis.motion_at(-1)
        with pytest.raises(PlantError, match=f"plant {name}.*no motion is recorded"):
            axis.ends_around(-1)
