"""What a machine answers when it is asked for its fault points."""

from contextlib import suppress
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults import plants
from axisrig.bench.machine.faults.acts import Injected, drawn
from axisrig.bench.machine.faults.images import KINDS
from axisrig.bench.machine.faults.injection import BESIDE, ON_CAN, ON_IMAGES, ON_LINES
from axisrig.bench.machine.faults.points import ROOMS, points
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.fault_targets import axes_of
from axisrig.bench.rig.reading.faults import fault_kinds, read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"

PLANT = SimpleNamespace(axes={}, probes={}, distances={})
"""Without FMUs: their inputs that can be held are in `test_plant_inputs.py`."""


def settings_of(rig: str, *changes: str) -> Settings:
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(RIGS / rig), assigned)
    check_rig(settings)
    return settings


def points_of(settings: Settings) -> dict[str, tuple[str, ...]]:
    machine: Any = SimpleNamespace(settings=settings, plant=PLANT)
    return {target: point.kinds for target, point in points(machine).items()}


def test_each_kind_of_the_table_is_in_the_module_of_its_room() -> None:
    of_rooms = {kind: room.__name__.rpartition(".")[2] for room in ROOMS for kind in room.KINDS}
    assert of_rooms == {kind.name: kind.room for kind in fault_kinds().values()}
    assert {*BESIDE, *ON_CAN, *ON_IMAGES, *ON_LINES} == {*fault_kinds()}
    assert {*ON_CAN} & {*ON_LINES} == {*ON_CAN} & {*ON_IMAGES} == {"power_loss"}


def test_names_are_those_of_a_plan() -> None:
    found = points_of(settings_of("probe-z.toml"))
    assert {"Z", "can1", "Z.TPDO1", "Z.RPDO1", "can1.SYNC", "probe"} <= {*found}
    assert "power_loss" in found["Z"]
    assert "encoder_loss" in found["Z"]
    assert found["can1"] == ("sync_loss", "sync_jitter", "babble")
    assert "heartbeat_loss" not in found["Z"]  # it sends none
    sends = points_of(settings_of("probe-z.toml", "drive:servo.heartbeat_ms=20"))
    assert "heartbeat_loss" in sends["Z"]


def test_a_line_has_faults_of_its_own() -> None:
    """Kinds of frames on CAN and kinds of lines go by the carrier of the segment."""
    found = points_of(settings_of("probe-z-ethercat.toml"))
    assert found["ec1"] == ("line_lost", "line_late", "line_unanswered")
    of_slave = ("power_loss", "line_corrupt", "slave_falls", "clock_jump")
    assert found["Z"][: len(of_slave)] == of_slave
    assert not {"bus_off", "reset", "slow_sdo"} & {*found["Z"]}
    assert "Z.TPDO1" not in found
    on_can = points_of(settings_of("probe-z.toml"))
    assert not {"line_lost", "slave_falls"} & {kind for kinds in on_can.values() for kind in kinds}


def test_a_drive_with_idents_has_faults_of_its_own() -> None:
    """Real-time bits, the service channel and its commands; other drives of a line have none."""
    own = {"bit_stuck", "soe_silent", "soe_refused", "command_ends"}
    assert own <= {*points_of(settings_of("probe-z-sercos.toml"))["Z"]}
    assert not own & {*points_of(settings_of("probe-z-ethercat.toml"))["Z"]}
    with pytest.raises(UserError, match="has no idents"):
        settings_of("probe-z-ethercat.toml", "fault:bit_stuck=Z")


@pytest.mark.interpreted
@pytest.mark.parametrize("kind", ["life_stuck", "function_late"])
def test_what_a_fault_holds_in_a_profidrive_drive_goes_on_after_it(kind: str) -> None:
    """As often as it comes; the other one of the two is left alone."""
    node = SimpleNamespace(holds_life=False, encoder=SimpleNamespace(holds_other=False))
    on: Any = SimpleNamespace(nodes={"Z": node})
    fault: Any = SimpleNamespace(axis="Z", values={})
    numbers: Any = None
    act = KINDS[kind](on, fault, numbers, Injected(kind, "Z"))
    held = (kind == "life_stuck", kind == "function_late")
    for _ in range(2):
        assert (node.holds_life, node.encoder.holds_other) == (False, False)
        act.begin()
        assert (node.holds_life, node.encoder.holds_other) == held
        act.end()
    assert (node.holds_life, node.encoder.holds_other) == (False, False)


def test_a_cyclic_segment_and_its_drives_have_faults_of_their_own() -> None:
    """Images of any drive there; sign of life and encoder interface of one that has them."""
    found = points_of(settings_of("probe-z-profidrive.toml"))["Z"]
    images = {"image_lost", "image_missed", "image_late"}
    assert images | {"life_stuck", "encoder_error", "function_late", "power_loss"} <= {*found}
    assert not {"bus_off", "line_lost", "bit_stuck"} & {*found}
    assert not images & {*points_of(settings_of("probe-z-ethercat.toml"))["Z"]}
    with pytest.raises(UserError, match="has no interface"):
        settings_of("probe-z-ethercat.toml", "fault:life_stuck=Z")


RIGS_WITH = {  # what is there besides: of these targets the first is a point, the second none
    "probe-xyz.toml": (("can2", "babble"), ("plc", "plc_lost")),
    "plc-io-node.toml": (("terminal.TPDO1", "drop"), ("terminal", "clock_off")),
    "manual-el1252.toml": (("terminal", "clock_off"), ("terminal.TPDO1", "drop")),
    "distance-z-variable.toml": (("gap", "sensor_drift"), ("plc", "plc_late")),
}


@pytest.mark.parametrize("rig", RIGS_WITH)
def test_what_is_a_point_a_plan_may_write_and_nothing_else(rig: str) -> None:
    settings = settings_of(rig)
    found = points_of(settings)
    (there, kind), (missing, other) = RIGS_WITH[rig]
    assert kind in found[there]
    assert other not in found.get(missing, ())
    cells = []
    for name in fault_kinds():
        targets = [target for target, kinds in found.items() if name in kinds]
        cells += [f"fault:{name}={' '.join(targets)}"] if targets else []
        for target in {*found} - {*targets}:
            with suppress(UserError) if name == "heartbeat_loss" else pytest.raises(UserError):
                read_faults(name, target, settings.rig)
    settings_of(rig, *cells)


def test_axes_of_a_point_are_those_whose_moments_count() -> None:
    machine: Any = SimpleNamespace(settings=settings_of("probe-xyz.toml"), plant=PLANT)
    found = points(machine)
    on = {name: axis.segment for name, axis in machine.settings.rig.axis.items()}
    assert found["X.TPDO1"].axes == found["X"].axes == ("X",)
    for segment in dict.fromkeys(on.values()):
        assert found[segment].axes == tuple(a for a in on if on[a] == segment)


def test_a_plant_is_of_the_axes_that_it_is_wired_to() -> None:
    """As motor, as second encoder, as probe; what no axis has is of them all."""
    rig = settings_of("distance-xz-one-segment.toml").rig
    assert (rig.axis["X"].encoder_2, rig.axis["Z"].encoder_2) == (None, "gap")
    for sensor, words in (("gap", "sensor"), ("gap.held", "input")):
        assert axes_of(sensor, [words], rig) == ("Z",)
    for name, table in rig.axis.items():
        assert axes_of(f"{table.plant}.load", ["input"], rig) == (name,)
    assert axes_of("elsewhere", ["sensor"], rig) == ("X", "Z")
    probing = settings_of("probe-xyz.toml").rig
    assert axes_of("probe", ["probe"], probing) == ("X", "Y", "Z")
    unwired = probing.axis["Y"].model_copy(update={"probe_1": None, "probe_2": None})
    fewer = probing.model_copy(update={"axis": probing.axis | {"Y": unwired}})
    assert axes_of("probe", ["probe"], fewer) == ("X", "Z")


INPUTS = {"x": ["load", "supply.on"], "z": ["load"], "probe": ["supply.on", "level"]}
"""Of plants that nothing is wired to; names of FMUs have dots of their own."""


@pytest.fixture
def with_inputs(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = {
        name: SimpleNamespace(spare_inputs=lambda found=found: found)
        for name, found in INPUTS.items()
    }
    monkeypatch.setattr(plants, "parts_of", lambda _plant: parts)


@pytest.mark.interpreted
@pytest.mark.usefixtures("with_inputs")
def test_inputs_of_plants_are_points_of_the_axes_that_have_these_plants() -> None:
    found = plants.points(SimpleNamespace(settings=settings_of("probe-xyz.toml"), plant=PLANT))  # type: ignore[arg-type]
    assert {target: point.axes for target, point in found.items()} == {
        "x.load": ("X",), "x.supply.on": ("X",), "z.load": ("Z",),
        "probe.supply.on": ("X", "Y", "Z"), "probe.level": ("X", "Y", "Z"),
    }  # fmt: skip
    assert {point.kinds for point in found.values()} == {("plant_input",)}
    assert [*found] == [point.target for point in found.values()]


@pytest.mark.interpreted
@pytest.mark.usefixtures("with_inputs")
@pytest.mark.parametrize("target", ["x.load", "x.supply.on", "probe.supply.on"])
def test_a_fault_holds_the_input_of_its_whole_name(
    monkeypatch: pytest.MonkeyPatch, target: str
) -> None:
    """At the value of its cell, from and until the instants at which it begins and ends."""
    calls: list[tuple[Any, ...]] = []

    def held(_plant: Any, *names: str) -> Any:
        return SimpleNamespace(
            begin=lambda *given: calls.append((*names, *given)),
            end=lambda *given: calls.append((*names, *given)),
        )

    monkeypatch.setattr(plants, "HeldInput", held)
    settings = settings_of("probe-xyz.toml", f"fault:plant_input={target} value=-2.5")
    clock = SimpleNamespace(now_ns=0)
    beside: Any = SimpleNamespace(settings=settings, plant=PLANT, clock=clock)
    act = plants.KINDS["plant_input"](beside, settings.faults[0], Random(1))
    assert calls == []
    names = tuple(target.split(".", 1))
    for call, now_ns in ((act.begin, 7), (act.end, 9)):
        clock.now_ns = now_ns
        call()
    assert calls == [(*names, -2.5, 7), (*names, 9)]


@pytest.mark.interpreted
@pytest.mark.usefixtures("with_inputs")
@pytest.mark.parametrize("target", ["x.level", "y.load", "z.supply.on"])
def test_an_input_that_is_not_there_is_refused_where_the_cell_is(target: str) -> None:
    """Of each of several: a right one before it changes nothing."""
    cells = ("probe.level value=1", f"{target} value=1")
    settings = settings_of("probe-xyz.toml", *(f"fault:plant_input={cell}" for cell in cells))
    beside: Any = SimpleNamespace(settings=settings, plant=PLANT, clock=None)
    with pytest.raises(UserError) as refused:
        plants.KINDS["plant_input"](beside, settings.faults[0], Random(1))
    assert refused.value.value == target
    assert refused.value.allowed == ", ".join(f"{n}.{i}" for n in INPUTS for i in INPUTS[n])
    assert f"fault:plant_input={cells[1]}" in str(refused.value)


def test_a_segment_is_of_all_axes_on_it() -> None:
    """X and Z share a bus; on lines and beside a second bus each has its own axes."""
    both = settings_of("distance-xz-one-segment.toml").rig
    for target in ("can1", "can1.SYNC"):
        assert axes_of(target, ["telegram", "bus"], both) == ("X", "Z")
    mixed = settings_of("probe-xyz-mixed.toml").rig
    for segment in mixed.segment:
        on = tuple(name for name, axis in mixed.axis.items() if axis.segment == segment)
        assert axes_of(segment, ["bus", "line"], mixed) == on
    line = settings_of("probe-xyz-ethercat.toml").rig
    assert axes_of("ec1", ["line"], line) == ("X", "Y", "Z")
    assert axes_of("Y", ["slave"], line) == ("Y",)


def test_each_further_fault_at_a_place_draws_numbers_of_its_own() -> None:
    """Of seed, kind, place and which one it is there; one at another place changes none of them."""
    rig = settings_of("probe-xyz.toml").rig
    like = read_faults("drop", "Z.TPDO1 p=0.5", rig)
    other = read_faults("drop", "X.TPDO1 p=0.5", rig) + read_faults("delay", "Z.TPDO1 by=1ms", rig)
    found = [numbers.random() for _, numbers in drawn(1, like * 4)]
    assert len({*found}) == 4
    among = [one for fault in like * 4 for one in (*other, fault)]
    numbers = [(fault, numbers.random()) for fault, numbers in drawn(1, among)]
    assert [number for fault, number in numbers if fault in like] == found
    assert len({number for _, number in numbers}) == 12
    assert not {*found} & {numbers.random() for _, numbers in drawn(2, like * 4)}
