"""Several steps in one call: the same results as one by one, and the same errors."""

import ctypes
import itertools
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.small_fmus import small_fmu

from axisrig.fmus import FMI_VERSIONS, ensure_built
from axisrig.fmus.build import build
from axisrig.kernel.cosim.fmi.fmu import EndedError, Exchange, FmuSlave, PlantError, load_fmu
from axisrig.kernel.cosim.fmi.library import Missing
from axisrig.kernel.cosim.fmi.roles import Roles, Source, map_roles
from axisrig.kernel.cosim.fmi.steps import (
    FUNCTION,
    ROWS,
    StepsInARow,
    offers_steps,
    plain_references,
)
from axisrig.kernel.cosim.plant import axis as axis_module
from axisrig.kernel.cosim.plant import distance as distance_module
from axisrig.kernel.cosim.plant import edges as edges_module
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.edges import LocatingProbe
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS, US, TimeNs

DEMAND = ["reference_position", "reference_velocity", "reference_time", "reference_end"]
GIVEN = {
    "AxisRig.Drives.ServoAxis": DEMAND,
    "AxisRig.Drives.KinematicAxis": DEMAND,
    "AxisRig.Sensors.DistanceSensor": [
        "step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end",
    ],
}  # fmt: skip
TERMINATING = """package Ends
  model Early
    output Real y(unit="1") "Time";
  equation
    y = time;
    when time > 0.0021 then
      terminate("enough");
    end when;
  end Early;
end Ends;
"""
GROWING = """package Grows
  model Fast
    output Real y(unit="1") "e to the power of 500 after 1 ms";
  equation
    y = exp(5e5*time);
  end Fast;
end Grows;
"""


@pytest.fixture
def load() -> Iterator[Callable[..., FmuSlave]]:
    """Load and initialise an instance of the FMU at a path."""
    slaves: list[FmuSlave] = []

    def loaded(path: Path) -> FmuSlave:
        slaves.append(load_fmu(path, f"slave {len(slaves)}"))
        slaves[-1].initialize(0)
        return slaves[-1]

    yield loaded
    for slave in slaves:
        slave.close()


def row(model: str, begin_ns: TimeNs, end_ns: TimeNs) -> list[float]:
    """Inputs of a step: a ramp that turns at times, or the way of a sensor."""
    begin_s, step_s = begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9
    if "Sensor" in model:
        return [begin_s, step_s, 0.01 - begin_s, -1.0, 0.01 - end_ns * 1e-9, -1.0]
    return [0.02 * begin_s, 0.03 if begin_ns % (1 * MS) else -0.02, begin_s, end_ns * 1e-9 + 1e-3]


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
@pytest.mark.parametrize("model", GIVEN)
def test_results_are_the_bits_of_single_steps(load, model: str, fmi: str) -> None:
    one, many = load(ensure_built(model, fmi=fmi)), load(ensure_built(model, fmi=fmi))
    if one.has("enabled"):
        for slave in (one, many):
            power = Exchange(slave, ["enabled"])
            power.values[0] = True
            power.write()
    reals = [name for name in one.names("output") if one.variable(name).type in ("Float64", "Real")]
    inputs, outputs = Exchange(one, GIVEN[model]), Exchange(one, reals)
    ends_ns = [48_000 + k * 50 * US + k % 3 for k in range(ROWS + 20)]
    expected, given = [], []
    for end_ns in ends_ns:
        inputs.values[:] = row(model, one.time_ns, end_ns)
        given += inputs.values[:]
        inputs.write()
        one.step_to(end_ns)
        outputs.read()
        expected.append(outputs.values[:])

    steps = StepsInARow(many, inputs.references, outputs.references)

    assert steps.take(ends_ns, given) == expected
    assert many.time_ns == one.time_ns == ends_ns[-1]
    many.step_to(ends_ns[-1] + MS)  # single steps go on where it ends


def test_other_fmus_do_not_offer_it(odd: Callable[..., FmuSlave]) -> None:
    assert not offers_steps(odd())


@pytest.mark.parametrize(
    ("is_there", "grid_ns", "offers"),
    [(True, None, True), (True, 10 * US, False), (False, None, False), (False, MS, False)],
)
def test_an_fmu_with_a_grid_of_steps_is_stepped_one_by_one(
    is_there: bool, grid_ns: int | None, offers: bool
) -> None:
    """Between the points of a grid its outputs hold: it goes to the next point in each step."""
    found: Any = (lambda *_: 0) if is_there else Missing(FUNCTION)
    slave: Any = SimpleNamespace(grid_ns=grid_ns, function=lambda _name, _kinds: found)
    assert offers_steps(slave) is offers


def test_only_scalars_of_doubles_without_conversion(load) -> None:
    servo = load(ensure_built("AxisRig.Drives.ServoAxis"))
    assert plain_references([Exchange(servo, ["position"]), Exchange(servo, ["force"])])
    assert plain_references([Exchange(servo, ["position"]), Exchange(servo, ["enabled"])]) is None
    assert plain_references([object()]) is None


def test_rows_end_before_the_step_that_fails(load) -> None:
    servo = load(ensure_built("AxisRig.Drives.ServoAxis"))
    steps = StepsInARow(
        servo,
        Exchange(servo, ["reference_position"]).references,
        Exchange(servo, ["position"]).references,
    )
    rows = steps.take([1 * MS, 2 * MS, 3 * MS], [0.0, float("nan"), 0.0])
    assert len(rows) == 1
    with pytest.raises(PlantError, match=r"t = 1\.0+ ms: .*reference_position = -?nan is outside"):
        steps.refuse(2 * MS)


@pytest.mark.long
@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_model_that_ends_the_simulation_says_so_at_its_time(load, tmp_path, fmi: str) -> None:
    (tmp_path / "Ends").mkdir()
    (tmp_path / "Ends" / "package.mo").write_text(TERMINATING, encoding="utf-8")
    ends = load(build("Ends.Early", tmp_path / "ends.fmu", tmp_path / "Ends", fmi=fmi))
    steps = StepsInARow(ends, outputs=Exchange(ends, ["y"]).references)
    assert len(steps.take([k * MS for k in range(1, 6)])) == 2
    with pytest.raises(EndedError, match=r"t = 2\.1\d* ms: the FMU ended the simulation; .*enough"):
        steps.refuse(3 * MS)


def test_numbers_that_are_not_finite_never_come_back(load, tmp_path) -> None:
    """`PlantAxis` keeps the rows as they are."""
    (tmp_path / "Grows").mkdir()
    (tmp_path / "Grows" / "package.mo").write_text(GROWING, encoding="utf-8")
    grows = load(small_fmu("Grows.Fast", tmp_path / "Grows"))
    steps = StepsInARow(grows, outputs=Exchange(grows, ["y"]).references)
    ((y,),) = steps.take([1 * MS, 2 * MS, 3 * MS])
    assert y == pytest.approx(1.4035922e217)  # e^500, from a table
    with pytest.raises(PlantError, match="y is not a finite number"):
        steps.refuse(2 * MS)


@pytest.fixture
def at_a_stop(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[bool], list[PlantAxis]]]:
    """Drive the two sides of a gantry against their stops; return its axes."""
    plants: list[Plant] = []

    def run(in_a_row: bool) -> list[PlantAxis]:
        if not in_a_row:
            monkeypatch.setattr(axis_module, "offers_steps", lambda _slave: False)
        slave = load_fmu(ensure_built("AxisRig.Drives.GantryPair"), "x")
        for number, place in ((1, 2e-3), (2, 2.1e-3)):
            slave.set_start(f"stop_position_{number}", place)
        plants.append(Plant())
        plant = plants[-1]
        first = plant.add_axis(slave, _side(slave, 1))
        second = plant.add_axis_beside("x2", "x", _side(slave, 2))
        plant.initialize(0)
        for axis in (first, second):
            axis.command(0, 0.0, 0.043, 200 * MS, enabled=True)
        for end_ms in range(1, 141):
            plant.advance_to(end_ms * MS)
        return [first, second]

    yield run
    for plant in plants:
        plant.close()


def _side(slave: FmuSlave, number: int) -> Roles:
    names = (*DEMAND, "enabled", *axis_module.AXIS_OUTPUTS)
    sources = {name: Source(f"{name}_{number}") for name in names}
    return map_roles(slave, "axis", sources)


def test_contact_with_a_stop_is_the_same_either_way(at_a_stop) -> None:
    many, one = at_a_stop(True), at_a_stop(False)
    for mine, other in zip(many, one, strict=True):
        assert mine._many is not None or mine is many[1]
        assert other._many is None
        assert list(mine._times) == list(other._times)
        assert list(mine._past) == list(other._past)
        assert max(motion[axis_module.STOP_FORCE] for motion in mine._past) > 100.0
        assert mine.tick == other.tick


@pytest.mark.parametrize("stop_m", [-1e3, -1.2e-3])
@pytest.mark.parametrize("model", ["AxisRig.Drives.ServoAxis", "AxisRig.Drives.KinematicAxis"])
def test_distance_sensor_over_an_axis_is_the_same_either_way(monkeypatch, model, stop_m) -> None:
    """With a stop in its way the axis goes in fine steps, so that each step is a call then."""

    def run() -> tuple[PlantAxis, PlantDistance]:
        plant = Plant()
        slave = load_fmu(ensure_built(model), "z")
        if slave.has("stop_position"):
            slave.set_start("stop_position", stop_m)
            slave.set_start("stop_direction", -1)
            slave.set_start("kv", 100.0)
        axis = plant.add_axis(slave)
        eye = load_fmu(ensure_built("AxisRig.Sensors.DistanceSensor"), "eye")
        eye.set_start("workpiece.plane.level", -3e-3)
        eye.set_start("order", 2)
        sensor = plant.add_distance(eye, {"z": "z"})
        plant.initialize(0)
        axis.command(0, 0.0, -0.05, 60 * MS, enabled=True)
        for time_ns in (1, 999_000, 1_048_000, *range(2_048_000, 80 * MS, MS)):
            plant.advance_to(time_ns)
        plant.close()
        return axis, sensor

    many = run()
    for module in (axis_module, distance_module):
        monkeypatch.setattr(module, "offers_steps", lambda _slave: False)
    one = run()
    assert (many[1].walks, one[1].walks) == (True, False)
    assert list(many[0]._times) == list(one[0]._times)
    assert list(many[0]._past) == list(one[0]._past)
    assert list(many[1]._past) == list(one[1]._past)
    assert many[0].tick == one[0].tick
    assert many[1].distance_m < 2e-3
    steps_us = {int(b - a) // 1000 for a, b in itertools.pairwise(many[0]._times)}
    assert (50 in steps_us) == (stop_m > -1.0 and "Servo" in model)


@pytest.mark.parametrize("model", ["AxisRig.Drives.ServoAxis", "AxisRig.Drives.KinematicAxis"])
def test_edges_of_a_probe_are_the_same_either_way(monkeypatch, model: str) -> None:
    """The axis goes down onto a surface 1 mm below and up again: a contact, a rise and a fall."""

    def run() -> tuple[PlantAxis, LocatingProbe]:
        plant = Plant()
        axis = plant.add_axis(load_fmu(ensure_built(model), "z"))
        tip = load_fmu(ensure_built("AxisRig.Sensors.TouchProbe"), "tip")
        tip.set_start("surface", -1e-3)
        probe = plant.add_probe(tip, {"z": "z"})
        assert isinstance(probe, LocatingProbe)
        plant.initialize(0)
        axis.command(0, 0.0, -0.05, 80 * MS, enabled=True)
        plant.advance_to(80 * MS)
        axis.command(80 * MS, axis.motor_position_m(), 0.05, 200 * MS, enabled=True)
        for end_ms in range(81, 201):
            plant.advance_to(end_ms * MS)
        plant.close()
        return axis, probe

    many = run()
    for module in (axis_module, edges_module):
        monkeypatch.setattr(module, "offers_steps", lambda _slave: False)
    one = run()
    assert (many[1]._many is None, one[1]._many is None) == (False, True)
    assert list(many[0]._times) == list(one[0]._times)
    assert list(many[0]._past) == list(one[0]._past)
    assert many[1].signal.edges == one[1].signal.edges
    assert many[1].contacts == one[1].contacts
    assert [level for _, level in many[1].signal.edges] == [True, False]


def test_several_instants_with_a_foreign_axis_are_steps_one_by_one(fmu) -> None:
    """`walk` asks nothing of an FMU that offers no steps in a row."""
    sources = {"demand": Source("control.s_set"), "position": Source("table.s")}
    ends_ns = [250 * US, 500 * US, 740 * US]
    walked, stepped = Plant(), Plant()
    axes: list[PlantAxis] = []
    for plant in (walked, stepped):
        slave = load_fmu(fmu("table"), "table")
        axes.append(plant.add_axis(slave, map_roles(slave, "axis", sources)))
        plant.initialize(0)
        axes[-1].command(0, 0.0, 0.1, 1 * MS, enabled=True)
    axes[0].walk(ends_ns)
    motions = [axes[1].motion]
    for end_ns in ends_ns:
        axes[1].step_to(end_ns)
        motions.append(axes[1].motion)
    assert axes[0].walked == motions
    assert axes[0].motion == axes[1].motion
    assert axes[0].tick == axes[1].tick
    assert axes[0].tick[2] != 0.0
    for plant in (walked, stepped):
        plant.close()


def test_an_array_has_fewer_references_than_values(load) -> None:
    servo = load(ensure_built("AxisRig.Drives.ServoAxis"))
    scalar, array = Exchange(servo, ["position"]), Exchange(servo, ["position"])
    array.values = (ctypes.c_double * 3)()
    assert plain_references([scalar]) == scalar.references
    assert plain_references([array]) is None
    assert plain_references([scalar, array]) is None
