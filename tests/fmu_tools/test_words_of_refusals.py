"""What a refusal of an archive, a role or a start value names: file, place, kind, near ones."""

import errno
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.test_kinds_of_plants import fmu
from tests.cosim.test_roles_of_a_description import POSITION, slave_of

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.variables import start_vectors
from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import XML_DEPTH_MAX, unpack
from axisrig.kernel.cosim.fmi.roles import Source, coordinates_of, map_roles
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError

Pack = Callable[..., Path]
Refused = Callable[[Path], str]


# Archives


def test_an_fmu_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="FMU not found") as caught:
        unpack(tmp_path / "none.fmu")
    assert caught.value.file == str(tmp_path / "none.fmu")


def test_a_full_disk_is_named_with_the_folder_and_leaves_nothing(
    pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder of the session: it is this one that needs more room."""

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(archive, "_write", full)
    path = pack(("resources/full", b"of a test of a full disk"))
    before = sorted(session_folder().iterdir())
    with pytest.raises(UserError) as caught:
        unpack(path)
    words = f"the FMU cannot be unpacked into {session_folder()}: No space left on device"
    assert (caught.value.message, caught.value.file) == (words, str(path))
    assert sorted(session_folder().iterdir()) == before


@pytest.mark.parametrize(
    ("kind", "words"),
    [(stat.S_IFLNK, "a symbolic link"), (stat.S_IFIFO, "a named pipe"), (stat.S_IFSOCK, "a socket"),
     (stat.S_IFBLK, "a block device"), (stat.S_IFCHR, "a character device"),
     (0o030000, "neither a file nor a folder"), (0o070000, "neither a file nor a folder")],
)  # fmt: skip
def test_an_entry_of_another_kind_is_named_by_its_kind(
    pack: Pack, refused: Refused, kind: int, words: str
) -> None:
    """Types of <sys/stat.h>; two that no system has."""
    entry = zipfile.ZipInfo("resources/odd")
    entry.create_system, entry.external_attr = 3, (kind | 0o644) << 16
    assert f"entry 'resources/odd' is {words}" in refused(pack((entry, b"x")))


@pytest.mark.parametrize("lines", [0, 3])
def test_an_element_that_is_nested_too_deep_is_named_by_its_line(
    pack: Pack, refused: Refused, lines: int
) -> None:
    """The first one beyond the limit; two elements in a line."""
    count = XML_DEPTH_MAX + 1
    text = "\n" * lines + "".join("<a>" if n % 2 else "<a>\n" for n in range(1, count + 1))
    text = text + "</a>" * count
    line = lines + sum(n % 2 == 0 for n in range(1, count)) + 1
    message = refused(pack(description=text.encode()))
    assert f"modelDescription.xml, line {line}, is nested too deep" in message


# Roles


def test_a_variable_of_another_causality_has_near_ones_of_the_right_one() -> None:
    outputs = {f"{name}_out": ("output", "Float64", "m") for name in ("slide", "motor", "table")}
    slave = slave_of({**POSITION, "slide_in": ("input", "Float64", "m"), **outputs})
    with pytest.raises(UserError, match="position needs an output; slide_in has the") as caught:
        map_roles(slave, "axis", {"position": Source("slide_in")})
    assert caught.value.value == "slide_in"
    allowed = str(caught.value.allowed).split(", ")
    assert allowed[0] == "slide_out"
    assert "table_out" not in allowed
    bare = slave_of({"u": ("input", "Float64", "m"), "demand": ("input", "Float64", "m")})
    with pytest.raises(UserError) as caught:
        map_roles(bare, "axis", {"position": Source("u")})
    assert caught.value.allowed == "none"


@pytest.mark.parametrize(
    ("unit", "words"), [("1", "1"), ("rad2", "rad2"), ("N.mm", "kg.m2.s-2"), ("um", "m")]
)
def test_a_unit_that_does_not_fit_is_named_in_base_units(unit: str, words: str) -> None:
    """A number without a unit is 1; what has the power 1 is written without it."""
    slave = slave_of({**POSITION, "v": ("output", "Float64", unit)})
    with pytest.raises(UserError) as caught:
        map_roles(slave, "axis", {"velocity": Source("v")})
    assert caught.value.message == f"v is in {unit} ({words}), velocity needs a unit of m/s"


def test_a_role_that_is_mapped_to_nothing_is_left_out() -> None:
    """The variable of its name stays an input or output of the FMU alone."""
    more = {"force": ("output", "Float64", "N"), "enabled": ("input", "Boolean", None)}
    slave = slave_of({**POSITION, **more})
    assert set(map_roles(slave, "axis", {}).bound) == {*POSITION, *more}
    found = map_roles(slave, "axis", {"force": None, "enabled": None})
    assert set(found.bound) == set(POSITION)
    assert found.spare_inputs() == ["enabled"]


def test_a_note_on_a_namesake_is_the_reason_alone() -> None:
    """Without what a message has for a user who may map it: value, what is allowed, hint."""
    slave = slave_of({**POSITION, "force": ("output", "Float64", "s")})
    found = map_roles(slave, "axis", {})
    (note,) = [note for note in found.notes if "not taken" in note]
    assert note == "force of the FMU is not taken: force is in s (s), force needs a unit of N"


def test_coordinates_are_in_the_order_of_the_description_and_then_of_the_map() -> None:
    slave = fmu(("z_position", "a_position", "x_position"))
    assert coordinates_of(slave, "probe") == ["z", "a", "x"]
    mapped: Any = {"y_position": Source("v"), "b_position": Source("w")}
    assert coordinates_of(slave, "probe", mapped) == ["z", "a", "x", "y", "b"]


# Start values


@pytest.mark.parametrize("line", [2, 5])
@pytest.mark.parametrize(
    ("variability", "message"),
    [("constant", "the start value of x is not a number"),
     ("parameter", "start of x must not depend on a parameter")],
)  # fmt: skip
def test_a_start_value_that_is_no_number_or_moves_is_named_by_its_line(
    line: int, variability: str, message: str
) -> None:
    text = "model M\n" * (line - 1) + "  Real x(start = f(1));\nend M;\n"
    begin = text.index("  Real")
    span = {"source": 1, "start": begin, "end": begin + 9}
    variable = {
        "name": "x", "scalar_names": ["x"], "scalar_count": 1, "value_type": {"scalar": "real"},
        "declaration": {"span": span},
        "attributes": {"start": 0, "start_values": None, "binding": None, "binding_values": None},
    }  # fmt: skip
    expression = {
        "variability": variability, "provenance": {"span": span}, "operation": {"kind": "call"},
    }  # fmt: skip
    ir = Ir(
        "M", {"layout": {"bindings": {"x": {"Y": {"index": 0}}}}},
        {"variables": [variable], "expressions": [expression]}, {},
        {1: (Path("/models/M.mo"), text)}, Path("/models"),
    )  # fmt: skip
    system: Any = SimpleNamespace(y_count=1, p_count=0, initial=(), previous=())
    with pytest.raises(BuildError) as caught:
        start_vectors(ir, system)
    assert (caught.value.file, caught.value.line) == ("M.mo", line)
    assert caught.value.message == message
