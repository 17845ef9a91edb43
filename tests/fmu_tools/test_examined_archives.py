"""What is found out about an archive before its code runs: sizes, sums, folders, event mode."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fmpy
import pytest
from tests.fmu_tools.described import texts, variable

from axisrig.bench.tools.fmu import examine as examining
from axisrig.bench.tools.fmu.binaries import Binary
from axisrig.bench.tools.fmu.examine import examine

Pack = Callable[..., Path]
MODEL = b"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Plant" instantiationToken="t">
<CoSimulation modelIdentifier="plant"/>
<ModelVariables>
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="y" valueReference="1" causality="output"/>
</ModelVariables>
<ModelStructure><Output valueReference="1"/></ModelStructure>
</fmiModelDescription>
"""
BROKEN = MODEL.replace(b'fmiVersion="3.0"', b'fmiVersion="1.0"')


def sum_of(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize("description", [MODEL, BROKEN])
def test_the_size_of_an_archive_is_that_of_what_is_in_it(pack: Pack, description: bytes) -> None:
    """1 MiB and 0.5 MiB of zeros are packed into few bytes."""
    path = pack(("resources/a.bin", bytes(1 << 20)), ("resources/b.txt", bytes(1 << 19)),
                description=description)  # fmt: skip
    assert path.stat().st_size < 1 << 16
    found = examine(path)
    assert (found.findings[0].area, found.findings[0].level) == ("archive", "ok")
    assert found.findings[0].text == "3 entries, 1.50 MiB, nothing leaves its folder"


@pytest.mark.parametrize("description", [MODEL, BROKEN])
def test_an_fmu_that_cannot_run_here_has_its_sum_all_the_same(
    pack: Pack, description: bytes
) -> None:
    """Of a version that is not there, or without a library: it is not loaded."""
    path = pack(("resources/a.txt", b"a"), description=description)
    found = examine(path)
    assert (found.sha256, found.can_run) == (sum_of(path), False)
    assert texts(found.findings, "FAIL")


def test_an_archive_that_is_none_has_no_sum_and_one_finding(tmp_path: Path) -> None:
    path = tmp_path / "a.fmu"
    path.write_bytes(b"no archive")
    found = examine(path)
    assert (found.sha256, found.can_run) == ("", False)
    assert [(one.area, one.level) for one in found.findings] == [("archive", "FAIL")]


@pytest.mark.parametrize(
    ("problems", "by_fmpy", "shown"),
    [
        (["a"], ["a", "b"], ["a", "b"]),  # fmpy finds both
        ([], ["b"], ["b"]), (["a"], ["b"], ["a"]), (["a", "b"], ["b"], ["a", "b"]), ([], [], []),
    ],
)  # fmt: skip
def test_what_is_against_the_schema_is_never_left_out(
    problems: list[str], by_fmpy: list[str], shown: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(examining, "read_description", lambda _: ("description", list(problems)))
    monkeypatch.setattr(examining, "validate_model_description", lambda *_, **__: list(by_fmpy))
    found: Any = examining._read(Path())
    assert found == ("description", shown)


@pytest.mark.parametrize(("problems", "is_raised"), [(["a"], False), ([], True)])
def test_a_check_that_breaks_off_is_the_fault_of_what_is_against_the_schema(
    problems: list[str], is_raised: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: object, **__: object) -> list[str]:
        raise TypeError("odd")

    monkeypatch.setattr(examining, "read_description", lambda _: ("description", list(problems)))
    monkeypatch.setattr(examining, "validate_model_description", breaks)
    if is_raised:
        with pytest.raises(TypeError, match="odd"):
            examining._read(Path())
    else:
        found: Any = examining._read(Path())
        assert found == ("description", ["a"])


@pytest.mark.parametrize(("version", "word"), [("2.0", "platform"), ("3.0", "platform_tuple")])
def test_the_folder_of_a_library_is_named_as_its_version_of_fmi_names_it(
    version: str, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FMI 2.0.4, 2.3: linux64; FMI 3.0.1, 2.5.1.4: x86_64-linux. Another one is that of nobody."""
    folders = {"2.0": "linux64", "3.0": "x86_64-linux"}
    for name, folder in (("platform", folders["2.0"]), ("platform_tuple", folders["3.0"])):
        monkeypatch.setattr(fmpy, name, folder)
    binaries = [Binary(folder, "plant.so", "linux", ("x86_64",)) for folder in folders.values()]
    description: Any = SimpleNamespace(
        fmiVersion=version, coSimulation=SimpleNamespace(modelIdentifier="plant")
    )
    assert getattr(fmpy, word) == folders[version]
    for there in (binaries, binaries[::-1], binaries[:1], binaries[1:]):
        monkeypatch.setattr(examining, "find_binaries", lambda *_, of=there: of)
        failed = texts(examining._binaries(description, Path()), "FAIL")
        is_there = any(one.folder == folders[version] for one in there)
        missing = f"binaries/{folders[version]} holds no library plant"
        assert failed == ([] if is_there else [missing])


@pytest.mark.parametrize(
    ("word", "is_named"),
    [("true", True), (True, True), ("True", True), ("false", False), (False, False),
     (None, False), ("", False)],
)  # fmt: skip
def test_event_mode_without_clocks_is_named_where_the_fmu_has_it(word: Any, is_named: bool) -> None:
    description: Any = SimpleNamespace(
        modelVariables=[variable("y", causality="output", unit=None, declaredType=None)],
        coSimulation=SimpleNamespace(hasEventMode=word), unitDefinitions=[],
    )  # fmt: skip
    found = texts(examining._variables(description), "ok")
    assert any("it has event mode and no clocks" in text for text in found) is is_named
