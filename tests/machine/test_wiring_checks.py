"""What a rig may not wire: a probe, a sensor or a switch to what is of another kind."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import plants
from axisrig.bench.machine.plants import check_plants
from axisrig.kernel.errors import UserError


def rig(tmp_path: Path, **changes: Any) -> Any:
    path = tmp_path / "r.toml"
    path.write_text("[axis.Z]\nplant = 'z'\n", encoding="utf-8")
    axis = {"plant": "z", "signals": {}, "encoder_2": None}
    axis |= {key: value for key, value in changes.items() if key in axis}
    own = SimpleNamespace(
        axis={"Z": SimpleNamespace(**axis)}, plc=changes.get("plc", {}),
        plc_task=changes.get("task"),
    )  # fmt: skip
    return SimpleNamespace(rig=own, files=[path])


def probe(can_be_switched: bool = True) -> Any:
    return SimpleNamespace(can_be_switched=lambda: can_be_switched)


PLANT: Any = SimpleNamespace(
    axes={"z": None}, probes={"p": probe(), "fixed": probe(False)}, distances={"gap": None}
)


def task(switches: str | None = None, **inputs: str) -> Any:
    wired = {int(key[-1]): name for key, name in inputs.items()}
    return SimpleNamespace(terminal=SimpleNamespace(inputs=wired), switches=switches)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, None),
        ({"plant": "p"}, "axis Z: plant must name an axis plant of this rig"),
        ({"signals": {"probe_1": "p", "home": "fixed"}}, None),
        ({"signals": {"probe_1": "p", "probe_2": "gap"}}, "axis Z: probe_2 must name a probe"),
        ({"encoder_2": "gap"}, None),
        ({"encoder_2": plants.LOAD}, None),
        ({"encoder_2": "z"}, "axis Z: encoder_2 must name a distance sensor"),
        ({"encoder_2": "p", "signals": {"probe_1": "p"}}, "axis Z: encoder_2 must name a distance"),
        ({"encoder_2": "gap", "signals": {"probe_1": "gap"}}, "axis Z: probe_1 must name a probe"),
        ({"plc": {"V.E.S": SimpleNamespace(sensor="gap")}}, None),
        ({"plc": {"V.E.S": SimpleNamespace(sensor="p")}}, "V.E.S: sensor must name a distance"),
        ({"task": task(input_1="p", input_2="fixed")}, None),
        ({"task": task(input_2="gap")}, "plc.terminal.input_2 must name a probe or a switch"),
        ({"task": task(switches="p")}, None),
        ({"task": task(switches="p", input_1="fixed", input_2="p")}, None),
        (
            {"task": task(switches="p", input_1="gap")},
            "plc.terminal.input_1 must name a probe or a",
        ),
        ({"task": task(switches="fixed", input_1="p")}, "plc.switches must name a probe that can"),
        ({"task": task(switches="fixed")}, "plc.switches must name a probe that can be switched"),
        ({"task": task(switches="gap")}, "plc.switches must name a probe that can be switched"),
        ({"task": SimpleNamespace(terminal=None, switches=None)}, None),
    ],
)
def test_what_is_wired_is_of_its_kind(
    tmp_path: Path, changes: dict[str, Any], words: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plants, "check_strokes", lambda *_: None)
    monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset())
    settings = rig(tmp_path, **changes)
    if words is None:
        check_plants(settings, PLANT)
        return
    with pytest.raises(UserError) as caught:
        check_plants(settings, PLANT)
    assert caught.value.message.startswith(words)
    of_kind = {"a distance": "gap", "an axis": "z", "a probe": "p, fixed"}
    assert caught.value.allowed == next(v for k, v in of_kind.items() if f"name {k}" in words)
    assert caught.value.file == str(tmp_path / "r.toml")
    if "plc" not in words and "V.E." not in words:
        monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset({"Z"}))
        check_plants(settings, PLANT)  # nothing of an axis outside is simulated


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"task": task(input_1="p")}, "plc.terminal.input_1"),
        ({"task": task(switches="p")}, "plc.switches"),
    ],
)
def test_a_rig_without_probes_has_none_to_wire(
    tmp_path: Path, changes: dict[str, Any], keys: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset())
    monkeypatch.setattr(plants, "check_strokes", lambda *_: None)
    bare: Any = SimpleNamespace(axes={"z": None}, probes={}, distances={})
    with pytest.raises(UserError) as caught:
        check_plants(rig(tmp_path, **changes), bare)
    assert caught.value.message.startswith(f"{keys} must name a probe")
    assert (caught.value.value, caught.value.allowed) == ("p", "none in this rig")


@pytest.mark.parametrize("outside", [{"X"}, {"Y"}, {"X", "Y"}, {"Z"}, set()])
@pytest.mark.parametrize("wrong", ["X", "Y", "Z"])
def test_each_axis_that_is_simulated_is_checked_wherever_it_stands(
    tmp_path: Path, outside: set[str], wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An axis on real hardware before it, or behind it, says nothing about it."""
    monkeypatch.setattr(plants, "check_strokes", lambda *_: None)
    monkeypatch.setattr(plants, "outside_axes", lambda _: frozenset(outside))
    settings = rig(tmp_path)
    settings.rig.axis = {
        name: SimpleNamespace(plant="p" if name == wrong else "z", signals={}, encoder_2=None)
        for name in "XYZ"
    }
    if wrong in outside:
        check_plants(settings, PLANT)
        return
    with pytest.raises(UserError, match=f": axis {wrong}: plant must name an axis plant"):
        check_plants(settings, PLANT)
