"""Where an axis may be when a run begins, and whose value put it where it may not be."""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import start_places
from axisrig.bench.machine.plants import start_plant
from axisrig.bench.machine.start_places import START, STOP, blamed_start, check_places
from axisrig.bench.rig.contents import settings_of
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
PROBE = RIGS / "probe-z.toml"
REACH_MM = 20_480.0  # 2^31 increments of 2^20 per turn of 10 mm
NAMES = ["position_start", "stop_direction", "stop_position"]


def line_of(rig: Path, text: str) -> int:
    lines = rig.read_text(encoding="utf-8").splitlines()
    return 1 + next(number for number, line in enumerate(lines) if line.startswith(text))


def plant_of(
    position_mm: float, force_n: float = 0.0, face_mm: float = 0.0, *,
    names: list[str] = NAMES, has_face: bool = True,
) -> Any:  # fmt: skip
    """A plant whose axis is there, pressed by its stop."""
    axis = SimpleNamespace(
        position_m=lambda: position_mm / 1e3,
        motion=[position_mm / 1e3, *[0.0] * 5, force_n, face_mm / 1e3],
        slave=SimpleNamespace(names=lambda _kind: names),
        roles=SimpleNamespace(has=lambda name: has_face and name == "stop_face"),
    )
    return SimpleNamespace(axes={"z": axis}, notes=defaultdict(list))


def refused(plant: Any, *changes: str, rig: Path = PROBE) -> UserError:
    with pytest.raises(UserError) as caught:
        check_places(settings_of(rig, list(changes)), plant)
    return caught.value


@pytest.mark.parametrize("sign", [1, -1])
def test_an_axis_starts_in_reach_of_its_encoder(sign: int) -> None:
    """The ends themselves are out: 2^31 has no place in 32 bits with a sign."""
    check_places(settings_of(PROBE, []), plant_of(sign * (REACH_MM - 0.001)))
    for beyond_mm in (0.0, 5.0):
        error = refused(plant_of(sign * (REACH_MM + beyond_mm)))
        assert error.message == "axis Z starts outside the 32 bits of its encoder"
        assert error.value == f"{sign * (REACH_MM + beyond_mm):g} mm"
        assert error.allowed == "-20480 .. 20480 mm, ends out"
        assert (error.file, error.line) == (str(PROBE), line_of(PROBE, "start = { position_start"))


@pytest.mark.parametrize(
    ("position_mm", "inside", "allowed"),
    [
        (12.5, "2.5 mm", "at most 10 mm, the stop, with stop_direction 1"),
        (7.0, "3 mm", "at least 10 mm, the stop, with stop_direction -1"),
    ],
)
@pytest.mark.parametrize("force_n", [1.0, -1.0])
def test_an_axis_does_not_start_inside_its_stop(
    position_mm: float, inside: str, allowed: str, force_n: float
) -> None:
    plant = plant_of(position_mm, force_n, 10.0)
    error = refused(plant)
    assert error.message == f"axis Z is {inside} inside its stop when the run begins"
    assert (error.value, error.allowed) == (f"{position_mm:g} mm", allowed)
    assert error.hint is not None
    assert "of plant z; 1: the stop is met going up, -1: going down" in error.hint
    assert plant.notes == {}
    check_places(settings_of(PROBE, []), plant_of(position_mm, 0.0, 10.0))  # nothing presses


@pytest.mark.parametrize(
    ("names", "has_face"),
    [(["position_start"], True), (NAMES, False), ([], False)],
)
def test_a_stop_of_another_make_may_press_from_the_begin(names: list[str], has_face: bool) -> None:
    plant = plant_of(12.5, 250.0, 10.0, names=names, has_face=has_face)
    check_places(settings_of(PROBE, []), plant)
    assert plant.notes == {"z": ["its stop presses with 250 N when the run begins"]}


@pytest.mark.parametrize("force_n", [250.0, -31.5])
def test_what_is_noted_of_a_stop_stands_behind_what_is_noted_already(force_n: float) -> None:
    plant = plant_of(12.5, force_n, 10.0, names=[])
    plant.notes["z"].append("its lag is not known")
    check_places(settings_of(PROBE, []), plant)
    pressed = f"its stop presses with {force_n:g} N when the run begins"
    assert plant.notes == {"z": ["its lag is not known", pressed]}


def test_a_stop_of_one_axis_of_an_fmu_of_two_is_ours() -> None:
    """Their parameters have a number at their ends."""
    assert (
        "inside its stop" in refused(plant_of(12.5, 1.0, 10.0, names=["stop_direction_2"])).message
    )


def test_an_axis_outside_may_be_anywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_places, "outside_axes", lambda _: ["Z"])
    plant = plant_of(2 * REACH_MM, 250.0, 10.0, names=[])
    check_places(settings_of(PROBE, []), plant)
    assert plant.notes == {}


def test_a_part_of_an_fmu_has_the_start_values_of_its_owner() -> None:
    settings = settings_of(RIGS / "gantry-pair.toml", ["plant:x.position_start1=5"])
    of_part = next(name for name, table in settings.rig.plant.items() if table.shares == "x")
    for name in ("x", of_part):
        error = blamed_start(settings, name, UserError("odd"), START)
        assert error.file is None
        assert "plant:x.position_start1" in str(error)


@pytest.mark.parametrize(
    ("changes", "of_encoder", "of_stop"),
    [
        (["plant:z.position_start=5"], 0, 0),
        (["plant:z.position_start_mm=5", "plant:z.kv=40"], 0, 0),
        (["plant:z.position_start=5", "plant:z.stop_position=4"], 0, 1),  # the last one
        (["plant:z.stop_direction=-1", "plant:z.position_start=5"], 1, 1),
        (["plant:z.stop_speed=1"], None, 0),
        (["plant:z.kv=40"], None, None),
        ([], None, None),
    ],
)
def test_the_last_value_that_has_to_do_with_it_is_blamed(
    changes: list[str], of_encoder: int | None, of_stop: int | None
) -> None:
    """Else the table of the plant in the rig."""
    settings = settings_of(PROBE, changes)
    refusal = UserError("it starts there", value="1", allowed="2", hint="3")
    for names, place in ((START, of_encoder), (STOP, of_stop)):
        error = blamed_start(settings, "z", refusal, names)
        words = (error.message, error.value, error.allowed, error.hint)
        if place is None:
            assert words == ("it starts there", "1", "2", "3")
            assert error.file == str(PROBE)
            assert error.line == line_of(PROBE, "start = { position_start")
        else:
            column = changes[place].partition("=")[0]
            assert error.file is None
            assert column in str(error)


@pytest.mark.parametrize("start", ["", "start = { position_start_mm = 3 }\n"])
def test_without_start_values_the_plant_is_blamed(tmp_path: Path, start: str) -> None:
    """That of a part of an FMU is the one that has the FMU."""
    rig = tmp_path / "rig.toml"
    text = PROBE.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("start = { position_start")]
    at = lines.index('fmu = "AxisRig.Drives.ServoAxis"')
    lines[at + 1 : at + 1] = start.splitlines()
    text = "\n".join(lines).replace('"lists/', f'"{(RIGS / "lists").as_posix()}/')
    rig.write_text(text + "\n", encoding="utf-8")
    error = blamed_start(settings_of(rig, []), "z", UserError("odd"), START)
    expected = line_of(rig, "start = { position_start") if start else line_of(rig, "[plant.z]")
    assert (error.file, error.line) == (str(rig), expected)


@pytest.mark.parametrize(
    ("reason", "blamed"),
    [
        ("position_start1 is too far", "position_start1"),
        ("assert(Kv_2 > 0)", "Kv_2"),
        ("Kv_2 does not fit to position_start1", "Kv_2"),  # the last one of the run
        ("Kv_22 and position_start are bad", None),  # the names of others
        ("position_start12=3: bad", None),
        ("bad", None),
    ],
)
def test_an_fmu_that_refuses_its_begin_names_the_value_of_its_words(
    reason: str, blamed: str | None
) -> None:
    """A name may have capitals and digits; without one it is the plant in the rig."""
    settings = settings_of(RIGS / "gantry-pair.toml", ["plant:x.position_start1=5"])
    (given,) = settings.start["x"]
    settings.start["x"].append((replace(given[0], name="Kv_2", column="plant:x.Kv_2"), given[1]))

    def refuse(_time_ns: int) -> None:
        raise PlantError("x", 0, reason)

    with pytest.raises(UserError) as caught:
        start_plant(settings, SimpleNamespace(initialize=refuse))  # type: ignore[arg-type]
    assert f"x: {reason}" in caught.value.message
    if blamed is None:
        assert caught.value.file is not None
        assert caught.value.file.endswith("gantry-pair.toml")
    else:
        assert caught.value.file is None
        assert str(caught.value).startswith(f"--set plant:x.{blamed}")
