"""Inputs of plants that nothing is wired to, held by a fault: the supply of a probe."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.faults.injection import build_beside
from axisrig.bench.machine.faults.points import points
from axisrig.bench.machine.kept_fmus import close_plant
from axisrig.bench.machine.plants import build_plant, start_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.cosim.plant.inputs import HeldInput
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-workpiece.toml"
SUPPLY = "switched_on"
Built = tuple[Settings, Plant]


@pytest.fixture
def build() -> Iterator[Callable[..., Built]]:
    """Build the plants of a rig with a probe that has a supply."""
    with ExitStack() as opened:

        def make(*changes: str) -> Built:
            assigned = [(parse_assignment(text), as_written) for text in changes]
            settings = read_settings(*read_rig(RIG), assigned)
            check_rig(settings)
            plant = build_plant(settings)
            opened.callback(close_plant, plant)
            start_plant(settings, plant)
            return settings, plant

        yield make


@pytest.mark.parametrize(
    ("orders", "is_on"),
    [((), True), ((False,), False), ((False, True), True), ((True,), True)],
)
def test_the_last_order_counts_when_the_supply_comes_back(
    build: Callable[..., Built], orders: tuple[bool, ...], is_on: bool
) -> None:
    """The PLC may switch the probe meanwhile: it is off all the same."""
    _, plant = build()
    probe = plant.probes["probe"]
    held = HeldInput(plant, "probe", SUPPLY)
    held.begin(0.0, 2 * MS)
    assert probe.slave.get(SUPPLY) == 0
    for number, order in enumerate(orders, 3):
        plant.advance_to(number * MS)
        probe.switch(order, number * MS)
        assert probe.slave.get(SUPPLY) == 0
    held.end(7 * MS)
    assert probe.slave.get(SUPPLY) == is_on
    probe.switch(not is_on, 7 * MS)
    assert probe.slave.get(SUPPLY) == (not is_on)


def test_a_probe_that_is_off_at_the_start_can_be_switched_on(
    build: Callable[..., Built],
) -> None:
    _, plant = build("plant:probe.switched_on=0")
    probe = plant.probes["probe"]
    assert probe.slave.get(SUPPLY) == 0
    plant.advance_to(MS)
    probe.switch(True, MS)
    assert probe.slave.get(SUPPLY) == 1


def test_inputs_of_an_axis_get_their_value_back(build: Callable[..., Built]) -> None:
    """In newtons, the unit of the FMU; two of them and back in turn."""
    _, plant = build("plant:z.force_limit_n=700")
    slave = plant.axes["z"].slave
    first, second = HeldInput(plant, "z", "force_limit"), HeldInput(plant, "z", "force_limit")
    first.begin(12.5, MS)
    second.begin(3.0, 2 * MS)
    assert slave.get("force_limit") == 3.0
    second.end(3 * MS)
    assert slave.get("force_limit") == 12.5
    first.end(4 * MS)
    assert slave.get("force_limit") == 700.0


def test_a_machine_names_the_inputs_and_a_plan_gets_no_others(build: Callable[..., Built]) -> None:
    settings, plant = build("fault:plant_input=probe.switched_on value=0 at=armed for=5ms")
    machine: Any = SimpleNamespace(settings=settings, plant=plant)
    found = {name: point for name, point in points(machine).items() if "." in name}
    assert found["probe.switched_on"].kinds == ("plant_input",)
    assert found["probe.switched_on"].axes == ("Z",)
    assert "probe.z_start" not in found  # the axis is wired to it
    clock: Any = SimpleNamespace(now_ns=0)
    beside = ("fault:drop=Z.TPDO1", "fault:probe_stick=probe", "fault:encoder_freeze=Z")
    settings, plant = build(*beside, "fault:plant_input=probe.switched_on value=0")
    assert len(build_beside(Beside(settings, plant, clock), 0)) == 3  # all but that of frames
    wrong = "fault:plant_input=probe.switched_off"
    settings, plant = build(wrong)
    with pytest.raises(UserError, match=f"--set {wrong}.* no such input.*probe.switched_on"):
        build_beside(Beside(settings, plant, clock), 0)
    with pytest.raises(UserError, match="no such place of a fault"):
        build("fault:plant_input=prope.switched_on")


def test_the_inputs_of_a_cell_have_its_value_while_the_fault_acts(
    build: Callable[..., Built],
) -> None:
    """Two faults of two plants, on and off at instants of their own."""
    cells = ("probe.switched_on value=0", "z.force_limit value=12.5")
    settings, plant = build(
        "plant:z.force_limit_n=700", *(f"fault:plant_input={cell}" for cell in cells)
    )
    clock: Any = SimpleNamespace(now_ns=0)
    supply, limit = build_beside(Beside(settings, plant, clock), 0)
    axis, probe = plant.axes["z"].slave, plant.probes["probe"].slave

    def values(act: Callable[[], None], at_ms: int) -> tuple[float, float]:
        clock.now_ns = at_ms * MS
        plant.advance_to(clock.now_ns)
        act()
        return probe.get(SUPPLY), axis.get("force_limit")

    assert (probe.get(SUPPLY), axis.get("force_limit")) == (1, 700.0)
    assert values(supply.begin, 1) == (0, 700.0)
    assert values(limit.begin, 2) == (0, 12.5)
    assert values(supply.end, 3) == (1, 12.5)
    assert values(limit.end, 4) == (1, 700.0)


@pytest.mark.parametrize(
    ("target", "axes"), [("probe.switched_on", ("Z",)), ("z.force_limit", ("Z",))]
)
def test_an_input_that_another_plant_has_is_none_of_this_one(
    build: Callable[..., Built], target: str, axes: tuple[str, ...]
) -> None:
    """What is refused is named with all that could be meant."""
    settings, plant = build()
    machine: Any = SimpleNamespace(settings=settings, plant=plant)
    assert points(machine)[target].axes == axes
    other = {"probe": "z", "z": "probe"}[target.partition(".")[0]]
    wrong = f"{other}.{target.partition('.')[2]}"
    settings, plant = build(f"fault:plant_input={wrong} value=1")
    clock: Any = SimpleNamespace(now_ns=0)
    with pytest.raises(UserError) as caught:
        build_beside(Beside(settings, plant, clock), 0)
    assert caught.value.value == wrong
    assert target in str(caught.value.allowed)
