"""What is found out before the code of an FMU runs: paths, names, folders, capabilities."""

import itertools
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts, variable
from tests.fmu_tools.test_examined_archives import MODEL
from tests.fmu_tools.test_headers_of_libraries import elf, pe, put

from axisrig.bench.tools.fmu import examine as examining
from axisrig.bench.tools.fmu.binaries import find_binaries
from axisrig.bench.tools.fmu.examine import examine
from axisrig.fmus.compiler import this_platform
from axisrig.kernel.errors import UserError

Pack = Callable[..., Path]


@pytest.mark.parametrize("what", ["nothing", "a folder"])
def test_where_there_is_no_file_there_is_nothing_to_judge(tmp_path: Path, what: str) -> None:
    """The command line says so: it is no finding about an FMU."""
    path = tmp_path / "a.fmu"
    if what == "a folder":
        path.mkdir()
    with pytest.raises(UserError) as caught:
        examine(path)
    assert caught.value.file == str(path)


@pytest.mark.parametrize(
    ("machine", "can_run"), [(62, {"x86_64-linux"}), (183, {"aarch64-linux"}), (3, set())]
)
def test_a_library_of_another_processor_is_not_loaded(
    pack: Pack, machine: int, can_run: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The library is where it has to be by its name; its header names its processor."""
    here = this_platform().name
    monkeypatch.setattr(examining, "_capabilities", lambda *_: [])
    path = pack((f"binaries/{here}/plant{this_platform().ending}", elf(machine)), description=MODEL)
    found = examine(path)
    assert found.can_run is (here in can_run)
    assert bool(texts(found.findings, "FAIL")) is not found.can_run


@pytest.mark.parametrize("convention", ["structured", "flat"])
def test_names_against_the_convention_are_found_in_a_description(
    pack: Pack, convention: str
) -> None:
    """FMI 3.0.2, 2.4.7.5.1: a structured name has no blank."""
    words = f'modelName="Plant" variableNamingConvention="{convention}"'.encode()
    description = MODEL.replace(b'modelName="Plant"', words)
    two = description.replace(b'name="y"', b'name="two words"')
    for text, is_bad in ((description, False), (two, convention == "structured")):
        found = texts(examine(pack(description=text)).findings, "warn")
        assert sum('"two words" (line' in one for one in found) == is_bad


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "it is wrong"),
        ({"value": 0}, "it is wrong; found 0"),
        ({"value": ""}, "it is wrong; found "),
        ({"value": 3, "allowed": [1, 2]}, "it is wrong; found 3; allowed: 1, 2"),
        ({"allowed": ""}, "it is wrong; allowed: "),
    ],
)
def test_a_finding_of_an_error_has_its_value_and_what_is_allowed(
    given: dict[str, Any], text: str
) -> None:
    """None alone is none: 0 and an empty word are values. The hint says what to do."""
    error = UserError("it is wrong", **given)
    found = examining._failure("archive", error)
    assert (found.area, found.level, found.remedy) == ("archive", "FAIL", "")
    assert found.text == text
    assert examining._failure("a", UserError("no", hint="do it")).remedy == "do it"


WORDS = {"can_vary_step": (False, "one length only"), "needs_tool": (True, "needs the tool"),
         "once_per_process": (True, "once in a process"),
         "can_save_state": (False, "cannot be saved")}  # fmt: skip


@pytest.mark.parametrize("bad", list(itertools.product((False, True), repeat=4)))
def test_capabilities_warn_each_for_itself(
    bad: tuple[bool, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    can = {name: is_bad == worse for (name, (worse, _)), is_bad in
           zip(WORDS.items(), bad, strict=True)}  # fmt: skip
    own = SimpleNamespace(can_serialize_state=True, can_return_early=False, **can)
    monkeypatch.setattr(examining, "Capabilities", SimpleNamespace(of=lambda *_: own))
    first, *warnings = examining._capabilities(None, Path())  # type: ignore[arg-type]
    assert first.level == "ok"
    assert "serialises it: yes; returns early: no" in first.text
    wanted = [words for (_, words), is_bad in zip(WORDS.values(), bad, strict=True) if is_bad]
    assert len(warnings) == len(wanted)
    assert all(words in one.text for words, one in zip(wanted, warnings, strict=True))
    assert all(one.remedy for one in warnings)


def described(*variables: Any, has_event_mode: str = "false") -> Any:
    own = {"unit": None, "declaredType": None}
    made = [SimpleNamespace(**{**own, **vars(one)}) for one in variables]
    return SimpleNamespace(
        modelVariables=made, coSimulation=SimpleNamespace(hasEventMode=has_event_mode),
        unitDefinitions=[],
    )  # fmt: skip


@pytest.mark.parametrize("has", ["true", "false"])
def test_clocks_are_named_once_whatever_the_event_mode(has: str) -> None:
    """Clocks, and what waits for one. What is stepped without them is no second line."""
    clocked = variable("held", causality="output", type="Int32", clocks=["tick"])
    own = described(variable("y", causality="output", unit="m"), clocked,
                    variable("tick", type="Clock"), has_event_mode=has)  # fmt: skip
    found = [one for one in texts(examining._variables(own)) if "event mode" in one]
    assert found == ["it needs event mode, which is not there: clocks are not ticked: held, tick"]


@pytest.mark.parametrize(
    ("causality", "counts"),
    [
        ("input", True), ("output", True), ("parameter", False), ("local", False),
        ("calculatedParameter", False), ("independent", False), ("structuralParameter", False),
    ],
)  # fmt: skip
def test_units_are_those_of_what_a_rig_writes_and_reads(causality: str, counts: bool) -> None:
    own = described(variable("v", causality=causality))
    assert texts(examining._units(own, own.modelVariables), "warn") == (
        ["without a unit: v"] if counts else []
    )


@pytest.mark.parametrize(
    ("causality", "words"),
    [("input", "1 inputs, 0 outputs, 0 parameters, 0 locals"),
     ("output", "0 inputs, 1 outputs, 0 parameters, 0 locals"),
     ("parameter", "0 inputs, 0 outputs, 1 parameters, 0 locals"),
     ("local", "0 inputs, 0 outputs, 0 parameters, 1 locals"),
     ("independent", "0 inputs, 0 outputs, 0 parameters, 0 locals")],
)  # fmt: skip
def test_variables_are_counted_by_what_they_are_for(causality: str, words: str) -> None:
    own = described(variable("v", causality=causality))
    first, *_ = texts(examining._variables(own))
    assert first == words
    bare = texts(examining._variables(own), "warn")
    assert ("it has no outputs" in bare) is (causality != "output")


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"start": "1", "min": "1", "max": "2"}, None),
        ({"start": "2", "min": "1", "max": "2"}, None),
        ({"start": "0.5 3", "min": "1", "max": "2"}, "v = 0.5 (1 .. 2)"),
        ({"start": "nan", "min": "1"}, "v = nan (1 .. inf)"),
        ({"start": "-1", "min": "0", "causality": "parameter"}, "v = -1 (0 .. inf)"),
    ],
)
def test_a_start_value_may_be_one_of_its_limits(given: dict[str, Any], text: str | None) -> None:
    """The first one outside is named; what is no number is within nothing."""
    found = texts(examining._variables(described(variable("v", **given))), "warn")
    assert [one for one in found if one.startswith("start")] == (
        [] if text is None else [f"start outside min .. max: {text}"]
    )


@pytest.mark.parametrize("sign", [b"PE\0\1", b"PE\1\0", b"PF\0\0", b"pe\0\0"])
def test_a_library_of_windows_has_its_four_bytes(tmp_path: Path, sign: bytes) -> None:
    """Microsoft PE format, "Signature": PE and two zeros. PE\\0\\1 and others are no such file."""
    put(tmp_path, "win64", "plant.dll", pe(0x8664, sign=sign))
    put(tmp_path, "win32", "plant.dll", pe(0x14C))
    found = find_binaries(tmp_path, "plant")
    assert [(one.folder, one.system) for one in found] == [("win32", "windows"), ("win64", "")]
