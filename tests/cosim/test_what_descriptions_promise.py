"""Capabilities of a description, its index, its doubled names; session folders and cut notes."""

import gc
import struct
import weakref
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.model_description import ValidationError
from tests.cosim.test_roles_of_a_description import POSITION, slave_of
from tests.cosim.test_units_of_variables import LENGTHS, variable

from axisrig.kernel.cosim.fmi import fmu, journal
from axisrig.kernel.cosim.fmi.library import Capabilities
from axisrig.kernel.cosim.fmi.role_table import roles_of
from axisrig.kernel.cosim.fmi.roles import Source, map_roles
from axisrig.kernel.cosim.fmi.session import session_folder, share_session_folder
from axisrig.kernel.cosim.fmi.units import known_units, unit_of
from axisrig.kernel.cosim.fmi.variable_index import by_name, of_causality
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

FLAGS = {
    "canGetAndSetFMUstate": "can_save_state",
    "canSerializeFMUstate": "can_serialize_state",
    "mightReturnEarlyFromDoStep": "can_return_early",
    "canHandleVariableCommunicationStepSize": "can_vary_step",
    "canBeInstantiatedOnlyOncePerProcess": "once_per_process",
    "needsExecutionTool": "needs_tool",
}


def promised(
    *flags: str, internal: str | None = None, tool: str | None = None, folder: Path
) -> Capabilities:
    declared = {flag: flag in flags for flag in FLAGS}
    interface = SimpleNamespace(**declared, fixedInternalStepSize=internal)
    description: Any = SimpleNamespace(coSimulation=interface, generationTool=tool)
    return Capabilities.of(description, folder)


@pytest.mark.parametrize("flag", FLAGS)
def test_each_capability_is_a_flag_of_its_own(flag: str, tmp_path: Path) -> None:
    """FMI 2.0.4, 4.3.1, and FMI 3.0.2, 4.3.1."""
    can = promised(flag, folder=tmp_path)
    assert [name for name in FLAGS.values() if getattr(can, name)] == [FLAGS[flag]]
    others = promised(*(other for other in FLAGS if other != flag), folder=tmp_path)
    assert [name for name in FLAGS.values() if not getattr(others, name)] == [FLAGS[flag]]


@pytest.mark.parametrize(
    ("internal", "tool", "step_s"),
    [
        ("0.001", "axisrig 1.0", 0.001), ("0.001", "other", 0.001), (None, "axisrig 1.0", 5e-5),
        (None, "axisrig", 5e-5), (None, "other", None), (None, None, None),
        (None, "made with axisrig", None),
    ],
)  # fmt: skip
def test_the_longest_step_of_its_annotation_counts_for_an_fmu_of_axisrig_that_names_no_other(
    internal: str | None, tool: str | None, step_s: float | None, tmp_path: Path
) -> None:
    text = '<fmiModelDescription><LongestInternalStep seconds="5e-5"/></fmiModelDescription>'
    (tmp_path / "modelDescription.xml").write_text(text, encoding="utf-8")
    assert promised(internal=internal, tool=tool, folder=tmp_path).fixed_step_s == step_s


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize(("names", "is_good"), [("ab", True), ("aa", False), ("aba", False)])
def test_names_that_are_there_twice_keep_an_fmu_out_with_any_number_of_problems(
    names: str, is_good: bool, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problems = tuple(f"problem {number}" for number in range(count))
    description: Any = SimpleNamespace(
        modelVariables=[SimpleNamespace(name=name, causality="local") for name in names],
        fmiVersion="3.0", coSimulation=SimpleNamespace(modelIdentifier="plant"),
    )  # fmt: skip
    monkeypatch.setattr(fmu, "unpack", lambda _: tmp_path)
    monkeypatch.setattr(fmu, "read_description", lambda _: (description, problems))
    with pytest.raises(UserError) as caught:
        fmu.load_description(Path("a.fmu"))
    more = " (and 1 more)" if count == 2 else ""
    assert caught.value.message.startswith(
        "the FMU has no binary"
        if is_good
        else f"the model description is rejected: problem 0{more}"
    )
    if not is_good:
        assert isinstance(caught.value.__cause__, ValidationError)


@pytest.mark.parametrize(
    ("written", "near"), [("mmm", "mm"), ("m/ss", "m/s"), ("quark9", ", ".join(known_units()))]
)
def test_a_unit_that_is_none_has_the_near_ones_else_all(written: str, near: str) -> None:
    with pytest.raises(UserError) as caught:
        unit_of(LENGTHS, variable(), written)
    allowed = str(caught.value.allowed)
    assert near.split(", ", maxsplit=1)[0] in allowed.split(", ")
    assert (len(allowed.split(", ")) == len(known_units())) is (written == "quark9")


class Described(SimpleNamespace):
    """A description that can be asked whether it is still there."""


def test_an_index_is_kept_for_the_last_descriptions_alone() -> None:
    """64 of them: a campaign over many FMUs does not hold all descriptions."""

    def one(number: int) -> Any:
        variables = [SimpleNamespace(name=f"v{number}", causality="input")]
        return Described(modelVariables=variables)

    first = one(0)
    assert list(by_name(first)) == ["v0"]
    gone = weakref.ref(first)
    del first
    later = [one(number) for number in range(1, 66)]
    for number, description in enumerate(later, 1):
        assert list(by_name(description)) == [f"v{number}"]
        assert by_name(description) is by_name(description)
        assert [v.name for v in of_causality(description, "input")] == [f"v{number}"]
        assert list(of_causality(description, "output")) == []
    gc.collect()
    assert gone() is None


@pytest.mark.parametrize("coordinates", [[], ["z"], ["x", "z"], ["z", "y", "x"]])
@pytest.mark.parametrize("kind", ["probe", "distance"])
def test_each_coordinate_has_roles_of_its_own(kind: str, coordinates: list[str]) -> None:
    """By `roles.csv`: where it begins and ends in a step, with its rates, and its position."""
    found = roles_of(kind, coordinates)
    ways = {"start", "rate_start", "end", "rate_end", "position"}
    for name in coordinates:
        assert {f"{name}_{way}" for way in ways} <= found.keys()
    assert ({f"contact_{name}" for name in coordinates} <= found.keys()) is (
        kind == "probe" or not coordinates
    )
    of_all = roles_of(kind, ["x", "y", "z"])
    left_out = {"x", "y", "z"} - set(coordinates)
    assert {name for name in of_all if name not in found} == {
        name for name in of_all
        if any(name.startswith(f"{each}_") and name.removeprefix(f"{each}_") in ways
               for each in left_out)
        or (kind == "probe" and name in {f"contact_{each}" for each in left_out})
    }  # fmt: skip


def test_a_count_is_handed_on_as_it_is() -> None:
    """Neither a unit nor a sign changes how often something came, or which control is chosen."""
    way = {f"z_{part}": ("input", "Float64", unit) for part, unit in
           (("start", "m"), ("rate_start", "m/s"), ("end", "m"), ("rate_end", "m/s"))}  # fmt: skip
    step = dict.fromkeys(("step_time", "step_size"), ("input", "Float64", "s"))
    edges = {"up": ("output", "Int32", None), "falling_count": ("output", "Int32", None),
             "rising_time": ("output", "Float64", "s"),
             "falling_time": ("output", "Float64", "s")}  # fmt: skip
    slave = slave_of({**step, **way, **edges, "signal": ("output", "Boolean", None)})
    found = map_roles(slave, "probe", {"rising_count": Source("up", sign=-1)}, ["z"])
    for name in ("rising_count", "falling_count"):
        assert found.bound[name].is_plain
        assert found.bound[name].to_si(3.0) == 3.0


@pytest.mark.parametrize("missing", ["control", "reference_acceleration", "reference_force"])
def test_half_a_group_is_none(missing: str) -> None:
    """What is there of it is an input that nothing is wired to."""
    units = {"control": None, "reference_acceleration": "m/s2", "reference_force": "N"}
    given = {
        name: ("input", "Int32" if unit is None else "Float64", unit)
        for name, unit in units.items()
        if name != missing
    }
    found = map_roles(slave_of({**POSITION, **given}), "axis", {})
    assert set(found.bound) == set(POSITION)
    assert found.spare_inputs() == [name for name in units if name != missing]
    assert [note for note in found.notes if "position modes only" in note] == [
        f"no {missing}: the drive offers position modes only"
    ]
    assert not any(found.has(name) for name in units)


@pytest.mark.parametrize("role", ["position", "signal"])
def test_an_array_is_neither_a_number_nor_a_level(role: str) -> None:
    kind, type_, unit = (
        ("axis", "Float64", "m") if role == "position" else ("probe", "Boolean", None)
    )
    inputs = "demand" if kind == "axis" else "z_position"
    slave = slave_of({inputs: ("input", "Float64", "m"), "v": ("output", type_, unit)})
    slave.variable("v").shape = (3,)
    with pytest.raises(UserError, match=f"{role} needs one number or level") as caught:
        map_roles(slave, kind, {role: Source("v")}, ["z"] if kind == "probe" else [])
    assert caught.value.value == type_


def test_the_folder_that_is_shared_last_counts(tmp_path: Path) -> None:
    """A process that works for one after the other unpacks where each of them asks for it."""
    own = session_folder()
    try:
        for name in ("first", "second"):
            share_session_folder(tmp_path / name)
            assert session_folder() == tmp_path / name
    finally:
        share_session_folder(own)
    assert session_folder() == own


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (b"a.fmu\0z\0fmi3DoStep", ("a.fmu", "z", "fmi3DoStep")), (b"a.fmu\0z", ("a.fmu", "z", "")),
        (b"a.fmu", ("a.fmu", "", "")), (b"", ("", "", "")),
        (b"a\0b\0c\0d\0e", ("a", "b", "c")), (b"\xff.fmu", ("\ufffd.fmu", "", "")),
    ],
)  # fmt: skip
@pytest.mark.parametrize("length", [0, 480])
def test_of_a_note_that_is_cut_what_is_there_is_read(
    text: bytes, names: tuple[str, str, str], length: int, tmp_path: Path
) -> None:
    """Code of others in the process can write there as well."""
    path = tmp_path / "note"
    path.write_bytes(struct.pack("<Q?xxxxxxxq", 7, True, 3 * MS) + text.ljust(length, b"\0"))
    found = journal.last_call(path)
    assert found is not None
    assert (found.file, found.instance, found.function) == names
    assert (found.number, found.is_inside, found.time_ns) == (7, True, 3 * MS)
