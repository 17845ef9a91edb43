"""Parts of a rig in a package: each with its own FMU, values and names, and what has no place."""

import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.tools.test_rig_export_parts import described, fmu, plant, settings

from axisrig.bench.rig.reading.file import MapTable
from axisrig.bench.tools.rig_export import package, parts
from axisrig.bench.tools.rig_export.package import export_rig
from axisrig.bench.tools.rig_export.parts import Part, _part, _refuse
from axisrig.kernel.errors import UserError

SERVO, PROBE = "AxisRig.Drives.ServoAxis", "AxisRig.Sensors.TouchProbe"
OF_A_WORKPIECE, SENSOR = "AxisRig.Sensors.WorkpieceProbe", "AxisRig.Sensors.DistanceSensor"


@pytest.mark.interpreted
def test_each_part_has_its_fmu_and_its_values_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = [Part(name, (name,), None, ()) for name in ("z", "x")]
    monkeypatch.setattr(package, "parts_of", lambda _: made)
    monkeypatch.setattr(package, "_values", lambda _: "values")
    monkeypatch.setattr(package, "_structure", lambda _, given: f"of {len(given)}".encode())
    monkeypatch.setattr(package, "_fmu", lambda part, fmi: f"{part.name} {fmi}".encode())
    monkeypatch.setattr(
        package, "_parameters", lambda _, part, values: f"{values} {part.name}".encode()
    )
    monkeypatch.setattr(package, "_in_words", lambda _, given, target: [target.name])
    whole: Any = None
    assert export_rig(whole, tmp_path / "a.ssp", "2.0") == ["a.ssp"]
    with zipfile.ZipFile(tmp_path / "a.ssp") as archive:
        assert {name: archive.read(name).decode() for name in archive.namelist()} == {
            "SystemStructure.ssd": "of 2",
            "resources/z.fmu": "z 2.0", "resources/z.ssv": "values z",
            "resources/x.fmu": "x 2.0", "resources/x.ssv": "values x",
        }  # fmt: skip


def test_a_part_of_several_shows_what_is_not_wired_inside_under_the_name_of_its_plant() -> None:
    """One alone keeps its names and is the FMU of its model; own models are joined once each."""
    axis = fmu(described("demand", "input"), described("position"), described("kv", "parameter"))
    probe = fmu(described("z_start", "input"), described("step_time", "input"),
                described("step_size", "input"), described("inverted", "input", "Boolean"),
                described("signal", "output", "Boolean"))  # fmt: skip
    whole = settings(z=plant(), x=plant(), a=plant("own/Feeler.mo", z="z"),
                     b=plant("own/Feeler.mo", z="z"), c=plant(PROBE, z="z"))  # fmt: skip
    known = {"z": axis, "x": axis, "a": probe, "b": probe, "c": probe}
    alone = _part(whole, parts._Group(["x"]), known)
    assert (alone.name, alone.plants, alone.model) == ("x", ("x",), SERVO)
    assert [(port.name, port.plant) for port in alone.ports] == [("demand", "x"), ("position", "x")]
    joined = _part(whole, parts._Group(["z", "x"], ["a", "b", "c"]), known)
    assert (joined.name, joined.model) == ("z_x", None)
    assert joined.plants == ("z", "x", "a", "b", "c")
    assert joined.own == (Path("own/Feeler.mo"),)
    assert [port.name for port in joined.ports] == [
        "z_demand", "z_position", "x_demand", "x_position",
        "a_inverted", "a_signal", "b_inverted", "b_signal", "c_inverted", "c_signal",
    ]  # fmt: skip
    assert joined.text.startswith("model Rig_z_x ")
    for name in "abc":
        assert f"  {name}.z_start = z.position;" in joined.text.splitlines()


STEP = (described("step_time"), described("step_size"))


def table(model: str = SERVO, *, lead_mm: float | None = None, **wire: str) -> Any:
    """A plant; lead_mm: with which the first position of `z` is an angle."""
    found = plant(model, **wire)
    found.map = {"z_start": MapTable.model_construct(variable="z_start", lead_mm=lead_mm)}
    return found


@pytest.mark.parametrize(
    ("plants", "reads", "words"),
    [
        ({"z": table(), "p": table(PROBE, z="z")}, STEP, []),
        ({"z": table("a.fmu"), "p": table(PROBE)}, STEP, ["plant z: a.fmu is no .mo and not of"]),
        ({"z": table(), "p": table(PROBE, z="q")}, STEP,
         ["plant p is wired to q, which is not simulated here"]),
        ({"z": table("AxisRig.Drives.RotaryAxis"), "p": table(PROBE, z="z")}, STEP,
         ["plant p is wired to z, a rotary axis"]),
        ({"z": table(), "x": table(), "p": table(PROBE, lead_mm=10.0, x="x", z="z")}, STEP,
         ["plant p is wired to z, a rotary axis"]),
        ({"z": table("AxisRig.Drives.KinematicAxis"), "p": table(PROBE, z="z")}, STEP,
         ["plant p: the compiler takes no touch probe on z, a KinematicAxis"]),
        ({"z": table("AxisRig.Drives.KinematicAxis"), "p": table(OF_A_WORKPIECE, z="z")}, STEP,
         ["plant p: the compiler takes no touch probe on z, a KinematicAxis"]),
        ({"z": table("AxisRig.Drives.KinematicAxis"), "p": table(SENSOR, z="z")}, STEP, []),
        ({"z": table(), "p": table(PROBE, z="z")}, STEP[:1],
         ["plant p: AxisRig.Sensors.TouchProbe is wired and reads no motion of an axis"]),
        ({"z": table("a/One.mo"), "y": table("b/Two.mo"), "p": table("c.fmu")}, STEP,
         ["plant p: c.fmu is no .mo", "own models are in several folders", "one can be"]),
        ({"z": table("a/One.mo"), "y": table("a/Two.mo")}, STEP, []),
        ({}, STEP, ["every axis of it is outside"]),
    ],
)  # fmt: skip
@pytest.mark.interpreted
def test_all_that_has_no_place_in_the_package_is_named_at_once(
    plants: dict[str, Any], reads: Any, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "_described", lambda _: fmu(*reads))
    whole = SimpleNamespace(rig=SimpleNamespace(plant=plants), files=[Path("rig.toml")])
    whole_rig: Any = whole
    if not words:
        _refuse(whole_rig, plants)
        return
    with pytest.raises(UserError, match="this rig cannot be exported: ") as caught:
        _refuse(whole_rig, plants)
    found = caught.value.message.partition(": ")[2].split("; ")
    assert len(found) == len(words)
    for text, begin in zip(found, words, strict=True):
        assert text.startswith(begin)
    assert caught.value.file == "rig.toml"
