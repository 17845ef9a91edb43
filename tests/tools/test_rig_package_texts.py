"""Structure and values of an SSP package, read by fmpy with its schemas; no FMU is built."""

import re
import zipfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.tools.rig_export import package
from axisrig.bench.tools.rig_export.package import (
    _as_text,
    _in_words,
    _parameters,
    _set_keys,
    _structure,
    _write,
)
from axisrig.bench.tools.rig_export.parts import Part, Port
from axisrig.fmus import BuildError
from axisrig.kernel.errors import UserError


def variable(name: str, causality: str, type_: str, unit: str | None = None) -> Any:
    return SimpleNamespace(name=name, causality=causality, type=type_, unit=unit, declaredType=None)


def port(name: str, causality: str, type_: str, unit: str | None = None) -> Port:
    return Port(f"p_{name}", "p", variable(name, causality, type_, unit))


PORTS = (
    port("demand", "input", "Float64", "m"),
    port("angle", "output", "Float64", "deg"),
    port("count", "output", "Int32", "m"),
    port("on", "input", "Boolean"),
    port("plain", "output", "Real"),
)
JOINED = Part("z", ("z", "probe"), None, PORTS)
ALONE = Part("x", ("x",), "AxisRig.Drives.ServoAxis", (port("speed", "output", "Float64", "m/s"),))


def settings(**plants: Any) -> Any:
    rig = SimpleNamespace(title="two <axes>", plant=plants)
    return SimpleNamespace(files=[Path("rigs/my-rig.toml")], rig=rig, start={})


VALUES = {
    "z": {"kv": ("Float64", 40.0), "count": ("Int32", 3.0), "on": ("Boolean", 1.0)},
    "probe": {"surface": ("Real", 0.1), "off": ("Boolean", 0.0)},
    "x": {"kv": ("Float64", 1e-12)},
}


@pytest.fixture
def made(tmp_path: Path) -> Path:
    target = tmp_path / "made.ssp"
    files = {"SystemStructure.ssd": _structure(settings(), [JOINED, ALONE])}
    for part in (JOINED, ALONE):
        files[f"resources/{part.name}.ssv"] = _parameters(settings(), part, VALUES)
    _write(target, files)
    return target


def test_components_have_their_connectors_with_type_and_unit(made: Path) -> None:
    """fmpy holds the file against the schema."""
    found = read_ssd(str(made))
    assert (found.name, found.system.name) == ("my-rig", "my-rig")
    joined, alone = found.system.elements
    assert [(one.name, one.source) for one in (joined, alone)] == [
        ("z", "resources/z.fmu"), ("x", "resources/x.fmu"),
    ]  # fmt: skip
    assert [(c.name, c.kind) for c in joined.connectors] == [
        ("p_demand", "input"), ("p_angle", "output"), ("p_count", "output"), ("p_on", "input"),
        ("p_plain", "output"),
    ]  # fmt: skip
    kinds = re.findall(r"<ssc:(Real|Integer|Boolean)\b", texts(made))
    assert kinds == ["Real", "Real", "Integer", "Boolean", "Real", "Real"]
    assert [c.name for c in alone.connectors] == ["p_speed"]
    assert not found.system.connectors


def texts(made: Path) -> str:
    with zipfile.ZipFile(made) as archive:
        return archive.read("SystemStructure.ssd").decode()


def test_a_unit_is_its_factor_and_exponents_of_si(made: Path) -> None:
    """SI: a degree is pi/180 rad, a speed m and 1/s; each unit is there once."""
    text = texts(made)
    assert [text.count(f'<ssc:Unit name="{name}">') for name in ("deg", "m", "m/s")] == [1, 1, 1]
    assert '<ssc:BaseUnit rad="1" factor="0.017453292519943295" />' in text
    assert '<ssc:BaseUnit m="1" />' in text
    assert '<ssc:BaseUnit m="1" s="-1" />' in text
    assert '<ssc:Real unit="deg" />' in text
    assert "<ssc:Integer />" in text  # a whole number has none
    assert "<ssc:Boolean />" in text
    assert 'description="two &lt;axes&gt;"' in text
    assert 'source="resources/x.ssv"' in text


def test_values_have_the_names_of_their_fmu_and_their_types(made: Path) -> None:
    """In one that joins several by plant and variable; all sets have the name of the rig."""
    for name, expected in (
        ("z", {"z.kv": "40.0", "z.count": "3", "z.on": "true", "probe.surface": "0.1",
               "probe.off": "false"}),
        ("x", {"kv": "1e-12"}),
    ):  # fmt: skip
        found = read_ssv(str(made), f"resources/{name}.ssv")
        assert found.name == "my-rig"
        assert {each.name: each.value for each in found.parameters} == expected


@pytest.mark.parametrize(
    ("kind", "value", "expected"),
    [
        ("Boolean", 1.0, ("Boolean", "true")),
        ("Boolean", 0.0, ("Boolean", "false")),
        ("Int32", 3.0, ("Integer", "3")),
        ("Integer", -2.0, ("Integer", "-2")),
        ("Float64", 0.1, ("Real", "0.1")),
        ("Real", 3.0, ("Real", "3.0")),
    ],
)
def test_the_word_of_a_type(kind: str, value: float, expected: tuple[str, str]) -> None:
    assert _as_text(kind, value) == expected


class Slave:
    """Has the variables it is given."""

    def __init__(self, *names: str) -> None:
        self._names = names

    def has(self, name: str) -> bool:
        return name in self._names


def test_keys_of_rig_and_row_are_variables_each_once() -> None:
    """The unit ends the key of the rig; a variable whose name ends like a unit keeps its name."""
    item = SimpleNamespace(column="plant:z.kv", name="kv")
    whole = settings()
    whole.start = {"z": [(item, None)], "x": [(SimpleNamespace(column="p:x.a", name="a"), None)]}
    table: Any = SimpleNamespace(start={"position_start_mm": 1, "kv": 40, "way_mm": 3})
    slave: Any = Slave("position_start", "kv", "way_mm")
    assert _set_keys(whole, "z", table, slave) == ["position_start", "kv", "way_mm"]


def test_a_variable_that_a_row_alone_sets_is_in_the_package_too() -> None:
    """Behind those of the rig, in the order of the row; those of other plants are not."""
    whole = settings()
    texts = ("plant:z.friction.stribeck_mm_s=6", "plant:z.kv=30", "plant:z.seed=2")
    whole.start = {
        "z": [(parse_assignment(text), None) for text in texts],
        "x": [(parse_assignment("plant:x.noise_um=1"), None)],
    }
    slave: Any = Slave("kv", "seed", "noise", "friction.stribeck")
    for start, expected in (
        ({}, ["friction.stribeck", "kv", "seed"]),
        ({"seed": 1, "kv": 40}, ["seed", "kv", "friction.stribeck"]),
    ):
        table: Any = SimpleNamespace(start=start)
        assert _set_keys(whole, "z", table, slave) == expected
    assert _set_keys(whole, "x", SimpleNamespace(start={}), slave) == ["noise"]  # type: ignore[arg-type]
    assert _set_keys(whole, "y", SimpleNamespace(start={}), slave) == []  # type: ignore[arg-type]


def test_the_bytes_depend_on_the_content_alone(tmp_path: Path) -> None:
    for name in ("a", "b"):
        _write(tmp_path / name, {"x": b"1", "y": b"2"})
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    with zipfile.ZipFile(tmp_path / "a") as archive:
        assert archive.namelist() == ["x", "y"]
        assert archive.read("y") == b"2"
        dates = {entry.date_time for entry in archive.infolist()}
    assert dates == {(1980, 1, 1, 0, 0, 0)}  # the first one that a ZIP archive can have: no clock
    with pytest.raises(UserError, match="the package cannot be written"):
        _write(tmp_path / "no" / "a", {"x": b"1"})


def test_the_command_says_what_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    tables = {
        "z": SimpleNamespace(map={}, stroke_mm=None, breaks=[]),
        "gap": SimpleNamespace(map={"a": "b"}, stroke_mm=None, breaks=[]),
        "x": SimpleNamespace(map={}, stroke_mm=0.0, breaks=[]),
        "y": SimpleNamespace(map={}, stroke_mm=None, breaks=[1.0]),
    }
    monkeypatch.setattr(package, "simulated_plants", lambda _: tables)
    head, *lines, last = _in_words(settings(), [JOINED, ALONE], Path("a.ssp"))
    assert head == "a.ssp: 2 FMUs"
    assert lines == [
        "z: joined from z, probe",
        "x: AxisRig.Drives.ServoAxis",
        "plant gap: its map is not in the package; its variables keep their names",
        "plant x: stroke_mm and breaks are checked by axisrig only",
        "plant y: stroke_mm and breaks are checked by axisrig only",
    ]
    assert last.startswith("not in it: buses")


# The FMUs and the values of a rig


class Built:
    """Stands for the compiler: keeps what it was asked for, and what was beside the source."""

    def __init__(self) -> None:
        self.asked: list[Any] = []
        self.error: BuildError | None = None

    def build(self, model: str, target: Path, source: Path, fmi: str) -> Path:
        if self.error is not None:
            raise self.error
        beside = sorted(file.name for file in target.parent.iterdir())
        text = source.read_text(encoding="utf-8")
        self.asked.append((model, source.name, text, beside, fmi))
        target.write_bytes(b"built")
        return target

    def ensure_built(self, model: str, fmi: str) -> Path:
        self.asked.append((model, fmi))
        return Path(__file__)


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> Built:
    found = Built()
    monkeypatch.setattr(package, "build", found.build)
    monkeypatch.setattr(package, "ensure_built", found.ensure_built)
    return found


@pytest.mark.interpreted
def test_an_fmu_is_of_the_library_of_an_own_file_or_joined(built: Built, tmp_path: Path) -> None:
    """A joined one has all models of the folder of its own ones beside it: they may use them."""
    for name in ("Own.mo", "Used.mo", "notes.txt"):
        (tmp_path / name).write_text(f"text of {name}", encoding="utf-8")
    own = tmp_path / "Own.mo"
    assert package._fmu(ALONE, "3.0") == Path(__file__).read_bytes()
    assert package._fmu(replace(ALONE, model=str(own)), "2.0") == b"built"
    joined = replace(JOINED, text="model Rig_z\nend Rig_z;\n", own=(own,))
    assert package._fmu(joined, "3.0") == package._fmu(replace(joined, own=()), "2.0") == b"built"
    assert built.asked == [
        ("AxisRig.Drives.ServoAxis", "3.0"),
        ("Own", "Own.mo", "text of Own.mo", [], "2.0"),
        ("Rig_z", "Rig_z.mo", joined.text, ["Own.mo", "Rig_z.mo", "Used.mo"], "3.0"),
        ("Rig_z", "Rig_z.mo", joined.text, ["Rig_z.mo"], "2.0"),
    ]
    built.error = BuildError("Rig_z.mo", 1, "no such class")
    with pytest.raises(UserError, match=r"the plants z, probe cannot be one FMU: .*no such class"):
        package._fmu(joined, "2.0")


@pytest.mark.interpreted
def test_values_are_those_of_each_plant_after_its_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """What lives in the FMU of another plant has none of its own; the plants are closed again."""
    calls: list[str] = []

    def slave(number: float, kind: str) -> Any:
        known = {"kv": SimpleNamespace(type=kind), "no": SimpleNamespace(type="Int32")}
        return SimpleNamespace(variable=known.__getitem__, get={"kv": number, "no": 3.0}.get)

    def kept(**plants: Any) -> dict[str, Any]:
        return {name: SimpleNamespace(slave=made) for name, made in plants.items()}

    plant = SimpleNamespace(
        axes=kept(z=slave(40.0, "Float64"), z2=slave(41.0, "Float64")),
        probes=kept(probe=slave(42.0, "Real")), distances=kept(gap=slave(43.0, "Float32")),
        initialize=lambda at: calls.append(f"initialize {at}"),
        close=lambda: calls.append("close"),
    )  # fmt: skip
    tables = {name: SimpleNamespace(shares=None) for name in ("z", "probe", "gap")}
    tables["z2"] = SimpleNamespace(shares="z")
    keys = {"z": ["kv", "no"], "probe": ["kv"], "gap": []}
    monkeypatch.setattr(package, "build_plant", lambda _: plant)
    monkeypatch.setattr(package, "simulated_plants", lambda _: tables)
    monkeypatch.setattr(package, "_set_keys", lambda _, name, *__: keys[name])
    assert package._values(settings()) == {
        "z": {"kv": ("Float64", 40.0), "no": ("Int32", 3.0)}, "probe": {"kv": ("Real", 42.0)},
        "gap": {},
    }  # fmt: skip
    assert calls == ["initialize 0", "close"]
    monkeypatch.setattr(package, "_set_keys", lambda *_: ["missing"])
    with pytest.raises(KeyError):
        package._values(settings())
    assert calls[-1] == "close"
