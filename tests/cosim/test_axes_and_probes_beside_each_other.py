"""Two axes or two probes of a plant made by hand, and contacts that come again: each one counts."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu, axis_of
from tests.cosim.test_probes_by_hand import Rig, Switch

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.plant import PARTS, Plant
from axisrig.kernel.time.clock import MS, US

SPEED_M_S = 0.1
EDGE_NS = 20 * US


def axis_fmu(name: str, *, is_held: bool = False) -> Fmu:
    """Moves at a speed, or only says so."""
    fmu = Fmu(
        *RAMP, velocity=SPEED_M_S, position=lambda ns: 0.0 if is_held else SPEED_M_S * ns * 1e-9
    )
    fmu.name = name
    fmu.can = SimpleNamespace(can_save_state=True, fixed_step_s=None)  # type: ignore[attr-defined]
    return fmu


def switch(name: str, axes: str, *, has_edge: bool = True) -> Switch:
    found = Switch(axes, lambda ns, _at: has_edge and ns >= EDGE_NS)
    found.name = name
    return found


def plant_of(axes: dict[str, Fmu], *probes: Switch) -> Plant:
    """Steps of 50 us, in which every probe is followed."""
    plant = Plant(50 * US, 50 * US)
    for fmu in axes.values():
        plant.add_axis(fmu, fmu.roles)  # type: ignore[arg-type]
    for probe in probes:
        sources = {name.removesuffix("_position"): name[0] for name in probe.inputs}
        plant.add_probe(probe, sources, probe.roles)  # type: ignore[arg-type]
    plant.initialize()
    return plant


@pytest.mark.parametrize("held", [(), ("x",), ("y",), ("x", "y")])
def test_each_axis_of_a_plant_has_to_go_on_in_a_step_with_an_edge(held: tuple[str, ...]) -> None:
    """Also one that the probe does not see: an FMU that stands still gives no places."""
    axes = {name: axis_fmu(name, is_held=name in held) for name in "xy"}
    plant = plant_of(axes, switch("probe", "x"))
    if held:
        with pytest.raises(PlantError, match="steps inside more coarsely") as found:
            plant.advance_to(50 * US)
        assert f"plant {held[0]} " in str(found.value).replace(":", " ")
    else:
        plant.advance_to(50 * US)
        (probe,) = plant.probes.values()
        assert probe.signal.edges == [(EDGE_NS, True)]


@pytest.mark.parametrize("with_edge", [(True, False), (False, True), (True, True), (False, False)])
def test_a_step_is_divided_when_any_probe_has_an_edge_in_it(with_edge: tuple[bool, bool]) -> None:
    """Each of them then has its edge at its instant."""
    axes = {"x": axis_fmu("x")}
    probes = [
        switch(f"probe {number}", "x", has_edge=has_edge)
        for number, has_edge in enumerate(with_edge)
    ]
    plant = plant_of(axes, *probes)
    plant.advance_to(50 * US)
    steps = axes["x"].steps
    assert len(set(steps)) == (PARTS if any(with_edge) else 1)
    edges = [probe.signal.edges for probe in plant.probes.values()]
    assert edges == [[(EDGE_NS, True)] if has_edge else [] for has_edge in with_edge]


def test_an_edge_of_a_step_that_is_done_again_is_one_edge() -> None:
    """The step is taken back before its edges are accepted."""
    rig = Rig(Switch("z", lambda ns, _at: ns >= EDGE_NS), "z")
    probe: Any = rig.probe
    probe.save()
    for _ in range(2):
        assert probe.step(0, 50 * US) == 1
        probe.restore()
    assert probe.step(0, 10 * US) == 0
    probe.accept(10 * US)
    assert probe.signal.edges == []
    rig.now_ns = 10 * US
    rig.step(50 * US, (0.0, 0.0))
    assert probe.signal.edges == [(EDGE_NS, True)]


def test_two_axes_of_one_fmu_have_the_ends_of_their_own_step() -> None:
    first = Fmu(*RAMP, position=lambda ns: ns * 1e-9, velocity=1.0)
    second = Fmu(*RAMP, position=lambda ns: -2.0 * ns * 1e-9, velocity=-2.0)
    second.roles.slave = first
    axis = PlantAxis(first.roles, lambda _ns: None)
    other = PlantAxis(second.roles, lambda _ns: None, axis, None, "other")
    for each in (axis, other):
        each.start(0)
    for end in (1, 2):
        first.time_ns = second.time_ns = (end - 1) * MS
        second.time_ns = end * MS  # it is the same FMU
        axis.step_to(end * MS)
        other.step_to(end * MS)
        assert axis.tick == pytest.approx(((end - 1) * 1e-3, 1.0, end * 1e-3, 1.0))
        assert other.tick == pytest.approx(((end - 1) * -2e-3, -2.0, end * -2e-3, -2.0))


# A contact


def test_a_contact_that_comes_again_is_found_by_its_own_time() -> None:
    """5 N at 1 ms and 3 N at 4 ms."""
    force = {MS: 5.0, 4 * MS: 3.0}
    axis = axis_of(Fmu(*RAMP, position=0.0, velocity=0.0, stop_force=lambda ns: force.get(ns, 0.0)))
    for end in range(1, 7):
        axis.step_to(end * MS)
    peaks = [axis.stop_force_peak_n(begin * MS, (begin + 1) * MS) for begin in range(5)]
    assert peaks == pytest.approx([5.0, 5.0, 0.0, 3.0, 3.0])
    assert axis.stop_force_peak_n(5 * MS, 6 * MS) == 0.0


@pytest.mark.parametrize("side", [1, -1])
def test_steps_are_fine_as_long_as_there_is_a_force(side: int) -> None:
    """Also where the axis is 2 mm inside the face of a soft stop, which is no gap."""

    def is_inside(ns: int) -> bool:
        return ns > 0

    fmu = Fmu(
        *RAMP, position=lambda ns: 0.3 + side * 2e-3 * is_inside(ns), velocity=0.0, stop_face=0.3,
        stop_force=lambda ns: 5.0 * is_inside(ns),
    )  # fmt: skip
    axis = axis_of(fmu)
    for end in range(1, 6):
        axis.step_to(end * 4 * axis.fine_ns)
    assert fmu.steps == [axis.fine_ns * (at + 1) for at in range(20)]
