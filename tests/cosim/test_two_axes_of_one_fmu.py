"""Two axes on one FMU: the stop of either side, and what an FMU does not report of a motion."""

from collections.abc import Callable, Iterator, Sequence

import pytest

from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu
from axisrig.kernel.cosim.fmi.role_table import roles_of
from axisrig.kernel.cosim.fmi.roles import Roles, Source, map_roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.outputs import AXIS_OUTPUTS
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS

STOP_M, V_M_S = 2e-3, 0.043
SUFFIXES = ("_1", "_2")


@pytest.fixture
def plant() -> Iterator[Callable[[], Plant]]:
    made: list[Plant] = []

    def make() -> Plant:
        made.append(Plant())
        return made[-1]

    yield make
    for each in made:
        each.close()


def roles_with(slave: FmuSlave, suffix: str, *left_out: str) -> Roles:
    sources: dict[str, Source | None] = {
        role: Source(role + suffix)
        for role in roles_of("axis", ())
        if suffix and slave.has(role + suffix)
    }
    return map_roles(slave, "axis", sources | dict.fromkeys(left_out))


def pair(
    plant: Plant, stop_of: str, absent_1: Sequence[str] = (), absent_2: Sequence[str] = ()
) -> tuple[PlantAxis, PlantAxis]:
    """Both sides run at V_M_S; one of them has a stop at STOP_M."""
    slave = load_fmu(ensure_built("AxisRig.Drives.GantryPair"), "x")
    for name in (f"stop_position{suffix}" for suffix in SUFFIXES):
        slave.set_start(name, STOP_M if name.endswith(stop_of) else 1.0)
    slave.set_start("kv", 40.0)
    first = plant.add_axis(slave, roles_with(slave, "_1", *absent_1))
    second = plant.add_axis_beside("x2", "x", roles_with(slave, "_2", *absent_2))
    plant.initialize(0)
    for axis in (first, second):
        axis.command(0, 0.0, V_M_S, 60 * MS, enabled=True)
    return first, second


def test_each_axis_has_its_own_name_and_both_the_fmu(plant: Callable[[], Plant]) -> None:
    whole = plant()
    first, second = pair(whole, "none")
    assert (first.name, second.name) == ("x", "x2")
    assert first.slave is second.slave
    assert whole.axes == {"x": first, "x2": second}


@pytest.mark.parametrize("stop_of", SUFFIXES)
@pytest.mark.parametrize("is_in_rows", [False, True])
def test_the_stop_of_either_side_is_met_in_fine_steps(
    plant: Callable[[], Plant], stop_of: str, is_in_rows: bool
) -> None:
    """The peak of its force does not depend on the steps that are asked for."""
    peaks, forces = [], []
    for step_ns in (MS, 4 * MS, 20 * MS):
        axes = pair(plant(), stop_of)
        ends_ns = range(step_ns, 80 * MS + 1, step_ns)
        if is_in_rows:
            axes[0].walk(ends_ns)
        else:
            for end_ns in ends_ns:
                axes[0].step_to(end_ns)
        at, free = (axes[0], axes[1]) if stop_of == "_1" else (axes[1], axes[0])
        peaks.append(at.stop_force_peak_n(0, 80 * MS))
        forces.append(at.motion[:])
        assert free.stop_force_peak_n(0, 80 * MS) == 0.0
    assert min(peaks) > 100.0
    assert peaks == [peaks[0]] * 3
    assert forces == [forces[0]] * 3


@pytest.mark.parametrize("is_in_rows", [False, True])
@pytest.mark.parametrize("left_out", [(("stop_face",), ()), ((), ("stop_force", "stop_face"))])
def test_each_axis_has_the_outputs_of_its_own_side(
    plant: Callable[[], Plant], left_out: tuple[tuple[str, ...], ...], is_in_rows: bool
) -> None:
    """One side reports less than the other; what the FMU says itself is the witness."""
    first, second = pair(plant(), "none", *left_out)
    second.command(0, 0.0, -V_M_S / 3, 60 * MS, enabled=True)
    ends_ns = range(MS, 30 * MS + 1, MS)
    if is_in_rows:
        first.walk(ends_ns)
    else:
        for end_ns in ends_ns:
            first.step_to(end_ns)
    slave = first.slave
    for axis, suffix, absent in zip((first, second), SUFFIXES, left_out, strict=True):
        names = [name for name in AXIS_OUTPUTS if name not in absent and slave.has(name + suffix)]
        assert len(names) == len(AXIS_OUTPUTS) - len(absent)
        found = dict(zip(AXIS_OUTPUTS, axis.motion, strict=True))
        assert found == {name: slave.get(name + suffix) if name in names else 0.0 for name in found}
        assert axis.motion_at(15 * MS)[0] != axis.motion[0] != 0.0


def test_far_from_any_stop_there_are_no_fine_steps(plant: Callable[[], Plant]) -> None:
    first, second = pair(plant(), "none")
    for end_ns in range(MS, 40 * MS + 1, MS):
        first.step_to(end_ns)
    assert len(first._times) == len(second._times) == 41


@pytest.mark.parametrize(
    "left_out", [("motor_velocity",), ("velocity",), ("motor_velocity", "velocity")]
)
def test_a_velocity_that_an_fmu_does_not_report_is_the_slope_of_its_own_position(
    plant: Callable[[], Plant], left_out: tuple[str, ...]
) -> None:
    """What the FMU says itself is the witness.

    Three points 250 us apart are off by h^2/3 of the jerk: below 300 m/s3 that is 6 um/s;
    the position of the other end, 1 um away and more, would be off by 1 um/h = 4 mm/s.
    """
    slave = load_fmu(ensure_built("AxisRig.Drives.ScrewAxis"), "x")
    rig = plant()
    axis = rig.add_axis(slave, roles_with(slave, "", *left_out))
    rig.initialize(0)
    axis.command(0, 0.0, 0.05, 400 * MS, enabled=True)
    apart = 0.0
    for end_ns in range(MS, 200 * MS + 1, MS):
        axis.step_to(end_ns)
        if end_ns > 5 * MS:
            motor, load = slave.get("motor_velocity"), slave.get("velocity")
            assert axis.motor_velocity_m_s() == pytest.approx(motor, abs=2e-5)
            assert axis.motion[1] == pytest.approx(load, abs=2e-5)
            apart = max(apart, abs(axis.motor_position_m() - axis.position_m()))
    assert apart > 1e-6


def test_both_axes_go_back_to_where_they_were_kept(plant: Callable[[], Plant]) -> None:
    """Twice, from another instant each time; what follows is what followed before."""
    first, second = pair(plant(), "_2")
    for kept_ms in (7, 12):
        first.step_to(kept_ms * MS)
        for axis in (first, second):
            axis.save()
        was = [axis.motion[:] for axis in (first, second)]
        first.step_to(20 * MS)
        after = [axis.motion[:] for axis in (first, second)]
        assert was != after
        for axis in (first, second):
            axis.restore()
        assert [axis.motion for axis in (first, second)] == was
        assert [axis._times[-1] for axis in (first, second)] == [kept_ms * MS] * 2
        first.step_to(20 * MS)
        assert [axis.motion for axis in (first, second)] == after
        for axis in (first, second):
            axis.restore()
