"""What a machine makes its channel, its recorder and its terminal of."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.test_parts_put_together import Made

from axisrig.bench.machine import deflection, plants
from axisrig.bench.machine import machine as module
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.reading.file import PlantTable
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class MadeChannel(Made):
    """A channel that keeps what it is warned of."""

    def __init__(self, *words: Any) -> None:
        super().__init__(*words)
        self.plc = SimpleNamespace(values={})
        self.warned: list[str] = []

    def warn(self, text: str) -> None:
        self.warned.append(text)


@pytest.mark.parametrize("is_paced", [False, True])
def test_a_channel_gets_operator_lists_and_what_each_part_has(
    monkeypatch: pytest.MonkeyPatch, is_paced: bool
) -> None:
    """Nobody waits for real axes to come to rest; every part warns and has its ways."""
    read: list[Any] = []
    for name in ("PlantMechanics", "Surroundings", "PlcSide"):
        monkeypatch.setattr(module, name, Made)
    monkeypatch.setattr(module, "Channel", MadeChannel)
    monkeypatch.setattr(module, "_axis_settings", lambda _, name: f"settings of {name}")
    settings_class = SimpleNamespace(read=lambda *words, **named: read.append((words, named)))
    monkeypatch.setattr(module, "ChannelSettings", settings_class)
    operator = SimpleNamespace(
        start_after_ns=7, optional_stop=True, after_end_ns=30 * MS, limit_ns=MS
    )
    links = {name: SimpleNamespace(warn=None) for name in "ZX"}
    parts = [
        SimpleNamespace(warnings=[f"limit {n}"], accesses={axis: f"way to {axis}"})
        for n, axis in enumerate("ZX")
    ]
    rig = SimpleNamespace(
        axis={"Z": 1, "X": 2}, channel=SimpleNamespace(cutting_licence=False),
        distance=SimpleNamespace(law="law"),
    )  # fmt: skip
    settings = SimpleNamespace(
        operator=operator, rig=rig, channel="list", external={"A": 1.0}, warnings=["list warns"],
        plc={"V.E.A": "0"},
    )  # fmt: skip
    machine: Any = SimpleNamespace(
        settings=settings, scheduler="clock", timing=SimpleNamespace(period_ns=MS), links=links,
        installed=parts, plant="plant", _hardware=object() if is_paced else None,
        _message="put out", _build_monitor=lambda: "monitor", _build_functions=lambda: "functions",
        _commands_of="commands",
    )  # fmt: skip
    channel: Any = Machine._build_channel(machine)
    clock, timing, axes, linked, around, _ = channel.words
    assert (clock, timing, linked) == ("clock", machine.timing, [links["Z"], links["X"]])
    assert axes == ["settings of Z", "settings of X"]
    assert (around.put_out, around.monitor, around.functions) == (
        "put out", "monitor", "functions",
    )  # fmt: skip
    mechanics = around.mechanics
    assert mechanics.words == ("clock", "plant")
    assert (mechanics.waits, mechanics.after_end_ns) == (not is_paced, 30 * MS)
    assert read == [(("list",), {
        "start_after_ns": 7, "optional_stop": True, "cutting_licence": False, "law": "law",
    })]  # fmt: skip
    assert channel.plc.values == {"A": 1.0}
    for link in links.values():
        link.warn("of a link")
    assert channel.warned == ["list warns", "limit 0", "limit 1", "of a link", "of a link"]
    assert machine.plc_side.words == (
        channel, {"Z": "way to Z", "X": "way to X"}, settings.plc, "clock", MS, "commands",
    )  # fmt: skip


def test_a_recorder_gets_each_axis_with_its_plant_and_the_wires(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "Recorder", Made)
    monkeypatch.setattr(module, "is_rotary", lambda _, name: name == "C")
    monkeypatch.setattr(module, "torque_arm_m", lambda _, name: {"Z": 0.5, "C": 1.0}[name])
    axes = {name: SimpleNamespace(plant=name.lower()) for name in "ZC"}
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(rig=SimpleNamespace(axis=axes)), installed="parts",
        plant=SimpleNamespace(axes={"z": "plant z"}, probes="probes"), drives={"Z": "drive Z"},
        beside=SimpleNamespace(wires={"probe": "wire"}), _carriers={"can1": 1, "can2": 2},
    )  # fmt: skip
    made: Any = Machine._build_recorder(machine, "writer")  # type: ignore[arg-type]
    plant, recorded, probes, parts, writer = made.words
    assert (plant, probes, parts, writer) == (machine.plant, "probes", "parts", "writer")
    assert [tuple(vars(one).values()) if hasattr(one, "__dict__") else tuple(one)
            for one in recorded] == [
        ("Z", "plant z", "drive Z", False, 0.5), ("C", None, None, True, 1.0),
    ]  # fmt: skip
    assert (made.segments, made.wires) == (2, {"probe": "wire"})


@pytest.mark.parametrize("carried_by", [None, 0, 1])
def test_a_terminal_is_on_the_segment_that_has_it_or_on_one_of_its_own(
    monkeypatch: pytest.MonkeyPatch, carried_by: int | None
) -> None:
    """Its own reads what comes of the wires, faults included."""
    monkeypatch.setattr(module, "Terminal", Made)

    def part(number: int) -> Any:
        return SimpleNamespace(
            terminal=lambda advance: f"of {number} by {advance}" if number == carried_by else None
        )

    task: Any = SimpleNamespace(terminal="table")
    machine: Any = SimpleNamespace(
        plant=SimpleNamespace(advance_to="advance", probes={}), installed=[part(0), part(1)],
        beside=SimpleNamespace(signals="what comes", stamps="stamps"),
    )  # fmt: skip
    found: Any = Machine._build_terminal(machine, task, 5)
    if carried_by is not None:
        assert found == f"of {carried_by} by advance"
        return
    assert found.words == (task, "table", "what comes", "advance", 5, "stamps")
    assert Machine._build_terminal(machine, SimpleNamespace(terminal=None), 5) is None  # type: ignore[arg-type]


def test_an_fmu_that_cannot_be_loaded_is_named_with_its_file(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    rig = tmp_path / "z.toml"
    rig.write_text('[plant.z]\nkind = "axis"\nfmu = "models/broken.fmu"\n', "utf-8")

    def refuse(*_: Any) -> Any:
        raise UserError("it is no FMU", hint="made by nobody")

    monkeypatch.setattr(plants, "load_fmu", refuse)
    settings: Any = SimpleNamespace(files=[rig])
    with pytest.raises(UserError) as caught:
        plants._load(settings, "z", PlantTable(fmu="models/broken.fmu"))
    assert caught.value.message == "it is no FMU (broken.fmu)"
    assert caught.value.hint == "made by nobody"
    assert (caught.value.file, caught.value.line) == (str(rig), 3)


@pytest.mark.parametrize("scale", [1e-6, 1e-4, 1e-3, 1.0])
def test_a_direction_has_the_length_1_however_slow_the_axes_are(scale: float) -> None:
    """1 um/s is motion; what an axis at rest creeps with is none."""
    assert deflection._unit([3.0 * scale, -4.0 * scale]) == pytest.approx([0.6, -0.8])
    assert deflection._unit([0.0, 0.0]) is None
    assert deflection._unit([3e-10, 4e-10]) is None
