"""`axisrig fmu check`: what is found about FMUs that are good, flawed, deadly or none."""

import json
import platform
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Build = Callable[..., Path]
Rows = Mapping[str, list[Mapping[str, str]]]

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="the FMUs of this test end by POSIX signals"
)


@pytest.fixture
def checked(axisrig: Call) -> Callable[..., tuple[int, Rows]]:
    """Check one FMU; gives the exit code and the findings by area."""

    def check(fmu: Path, *options: str) -> tuple[int, Rows]:
        code, out, err = axisrig("fmu", "check", fmu, "--json", *options)
        assert err == ""
        (answer,) = json.loads(out)["fmus"]
        assert answer["file"].endswith(".fmu")
        assert fmu.stem in answer["file"]
        rows: dict[str, list[Mapping[str, str]]] = {}
        for finding in answer["findings"]:
            rows.setdefault(finding["area"], []).append(finding)
        words = {finding["level"] for finding in answer["findings"]}
        assert answer["verdict"] == ("FAIL" if "FAIL" in words else max(words))
        assert code == (1 if "FAIL" in words else 0)
        return code, rows

    return check


Check = Callable[..., tuple[int, Rows]]


def _of_level(rows: Rows, level: str) -> dict[str, str]:
    """The texts of the findings of one level, by area."""
    texts: dict[str, list[str]] = {}
    for area, findings in rows.items():
        for finding in findings:
            if finding["level"] == level:
                texts.setdefault(area, []).append(finding["text"])
    return {area: "; ".join(found) for area, found in texts.items()}


def _failed(rows: Rows) -> dict[str, str]:
    return _of_level(rows, "FAIL")


def _warned(rows: Rows) -> dict[str, str]:
    return _of_level(rows, "warn")


@pytest.mark.long
def test_a_good_fmu(checked: Check, ideal_axis: Build) -> None:
    code, rows = checked(ideal_axis())
    assert code == 0
    assert _failed(rows) == {}
    assert list(rows) == [
        *("archive", "description", "platforms", "capabilities", "variables", "units"),
        *("library", "call sequence", "steps", "determinism", "reset", "state", "state as bytes"),
        *("instances", "roles", "repeatability"),
    ]
    assert "kind axis: has all it needs by its own names" in rows["roles"][0]["text"]
    assert _warned(rows)["roles"].startswith("axis: no kv: ")
    assert _warned(rows)["units"] == "without a unit: way"


@pytest.mark.long
def test_the_library_of_this_project_is_good(checked: Check) -> None:
    _, rows = checked(Path("TouchProbe"))
    assert _failed(rows) == {}


FLAWS = [
    ("ADDRESS", "repeatability", "a run in another process differs"),
    ("FORGETS", "state", "restored, the run differs: way at t = "),
    ("HOLDS", "steps", "its outputs stand still for steps below 1 ms"),
    ("FORGETS_BYTES", "state as bytes", "unpacked, the run differs: "),
    pytest.param(
        *("FLUSH", "call sequence", "switches denormal numbers"),
        marks=pytest.mark.skipif(platform.machine() != "x86_64", reason="SSE control word"),
    ),
]


@pytest.mark.long
@pytest.mark.parametrize(("flaw", "area", "text"), FLAWS)
def test_a_flaw_is_a_fail_of_its_own(
    checked: Check, ideal_axis: Build, flaw: str, area: str, text: str
) -> None:
    _, rows = checked(ideal_axis(FLAW=flaw))
    failed = _failed(rows)
    assert text in failed[area]
    assert set(failed) == {area}


@pytest.mark.long
@pytest.mark.parametrize(
    ("flaw", "texts"),
    [
        (
            "GLOBAL",
            {
                "instances": "two instances disturb each other: way at t = ",
                "state": "restored, the run differs: way at t = ",
            },
        ),
        (
            "COUNTS",
            {
                "instances": "two instances disturb each other: way at t = ",
                "determinism": "two runs differ: way at t = 1 ms is 1.0 and 2.0",
            },
        ),
    ],
)
def test_instances_that_know_of_each_other(
    checked: Check, ideal_axis: Build, flaw: str, texts: Mapping[str, str]
) -> None:
    _, rows = checked(ideal_axis(FLAW=flaw))
    failed = _failed(rows)
    assert set(failed) == set(texts)
    for area, text in texts.items():
        assert failed[area].startswith(text)


@pytest.mark.long
@pytest.mark.parametrize(
    ("flaw", "area", "text"),
    [
        ("NAN_OUTPUT", "call sequence", "outputs that are no finite number: way"),
        ("CHDIR", "call sequence", "changes the working folder of the process"),
        ("REFUSES", "steps", "refuses steps of 0.05 ms: doStep: error"),
        ("COUNTS_STEPS", "steps", "the course depends on the steps: way differs by "),
        ("STICKS", "reset", "a run after reset differs: "),
    ],
)
def test_what_the_bench_can_live_with_is_a_warning(
    checked: Check, ideal_axis: Build, flaw: str, area: str, text: str
) -> None:
    code, rows = checked(ideal_axis(FLAW=flaw))
    assert code == 0
    assert text in _warned(rows)[area]


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("crash_in", "area", "function"),
    [
        ("LOAD", "library", "load"),
        ("INSTANTIATE", "library", "fmi3InstantiateCoSimulation"),
        ("INITIALIZE", "call sequence", "fmi3ExitInitializationMode"),
        ("STEP", "call sequence", "fmi3DoStep"),
        ("GET", "call sequence", "fmi3GetFloat64"),
        ("SET", "determinism", "fmi3SetFloat64"),
        ("TERMINATE", "call sequence", "fmi3Terminate"),
        ("FREE", "library", "fmi3FreeInstance"),
    ],
)
def test_a_crash_is_a_finding(
    checked: Check, ideal_axis: Build, crash_in: str, area: str, function: str
) -> None:
    _, rows = checked(ideal_axis("deadly.fmu", CRASH_IN=crash_in))
    assert f"FMU deadly.fmu (plant trial) crashed in {function} " in _failed(rows)[area] or (
        crash_in == "SET"
        and f"FMU deadly.fmu (plant one) crashed in {function} " in _failed(rows)[area]
    )
    assert "SIGSEGV" in _failed(rows)[area]


@pytest.mark.long
def test_a_hang_is_a_finding(checked: Check, ideal_axis: Build) -> None:
    fmu = ideal_axis("stuck.fmu", CRASH_IN="STEP", CRASH_HOW="HANG")
    _, rows = checked(fmu, "--call-timeout", "1")
    text = _failed(rows)["call sequence"]
    assert text.startswith("a call did not come back within 1 s: it was in fmi3DoStep at t = 0.")


@pytest.mark.long
def test_a_missing_function_is_named(checked: Check, ideal_axis: Build) -> None:
    _, rows = checked(ideal_axis(WITHOUT_DESERIALIZE=1))
    assert _failed(rows)["library"] == "functions are missing: fmi3DeserializeFMUState"


# ---- The description


CHANGES = [
    (
        '<Float64 name="way"',
        '<Float64 name="way" valueReference="99"/><Float64 name="way"',
        "description",
        'unique-names: The variable name "way" (line ',
    ),
    ('causality="output"/>', 'causality="outlet"/>', "description", "illegal combination of"),
    ('fmiVersion="3.0"', 'fmiVersion="1.0"', "description", "FMI version 1.0"),
    ('fmiVersion="3.0"', 'fmiVersion="4.0"', "description", "FMI version 4.0"),
    (
        '<CoSimulation modelIdentifier="ideal"',
        '<ModelExchange modelIdentifier="ideal"/><CoSimulation modelIdentifier="other"',
        "platforms",
        "holds no library other",
    ),
    (
        'modelIdentifier="ideal"',
        'modelIdentifier="../ideal"',
        "usable here",
        "the model identifier is no C name; found ../ideal",
    ),
]


@pytest.mark.long
@pytest.mark.parametrize(("old", "new", "area", "text"), CHANGES, ids=[c[1][:30] for c in CHANGES])
def test_a_description_that_cannot_be_used(
    checked: Check, ideal_axis: Build, old: str, new: str, area: str, text: str
) -> None:
    _, rows = checked(ideal_axis(change=lambda good: good.replace(old, new, 1)))
    assert text in _failed(rows)[area]


@pytest.mark.long
def test_model_exchange_only(checked: Check, ideal_axis: Build) -> None:
    def change(text: str) -> str:
        text = text.replace("<CoSimulation", "<ModelExchange")
        return text.replace(' canHandleVariableCommunicationStepSize="true"', "")

    _, rows = checked(ideal_axis(change=change))
    assert _failed(rows)["usable here"] == "the FMU has no co-simulation interface"
    assert "export it for co-simulation" in rows["usable here"][0]["remedy"]


DOUBTFUL = [
    ('start="0.13"', 'start="0.13" max="0.1"', "variables", "position_start = 0.13 (-inf .. 0"),
    ('name="way"', 'name="way" unit="furlong"', "description", 'unit: The unit "furlong" of'),
    ('<InitialUnknown valueReference="15"/>', "", "description", "structure-initial: ModelStruct"),
    ('causality="output"/>', 'causality="local"/>', "description", "structure-outputs: ModelStru"),
    ("<ModelStructure>", "<ModelStructure><nonsense/>", "description", "schema: ERROR (line "),
]
"""Changes of a description that only a validator dislikes; the first one is no rule of it."""


@pytest.mark.long
@pytest.mark.parametrize(("old", "new", "area", "text"), DOUBTFUL, ids=[c[3][:9] for c in DOUBTFUL])
def test_a_description_that_a_validator_dislikes_runs_and_strict_refuses_it(
    checked: Check, ideal_axis: Build, old: str, new: str, area: str, text: str
) -> None:
    fmu = ideal_axis(change=lambda good: good.replace(old, new, 1))
    _, rows = checked(fmu)
    assert _failed(rows) == {}
    assert text in _warned(rows)[area]
    assert "call sequence" in rows
    code, rows = checked(fmu, "--strict")
    if area == "description":
        assert code == 1
        assert text in _failed(rows)[area]
        assert "call sequence" not in rows
    else:
        assert _failed(rows) == {}


@pytest.mark.long
@pytest.mark.parametrize(
    ("place", "level"),
    [("aarch64-windows", "FAIL"), ("linux64", "FAIL")],
)
def test_no_library_for_this_platform(
    checked: Check, ideal_axis: Build, place: str, level: str
) -> None:
    _, rows = checked(ideal_axis(place=place))
    assert rows["usable here"][0]["level"] == level
    assert f"found {place}" in rows["usable here"][0]["text"]


@pytest.mark.long
def test_a_library_in_the_folder_of_another_platform(checked: Check, ideal_axis: Build) -> None:
    fmu = ideal_axis()
    with zipfile.ZipFile(fmu) as archive:
        name = next(n for n in archive.namelist() if n.startswith("binaries/"))
        library = archive.read(name)
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("binaries/x86_64-windows/ideal.dll", library)
    _, rows = checked(fmu)
    assert "x86_64-windows says x86_64 on windows, its library is" in _warned(rows)["platforms"]


@pytest.mark.long
def test_bytes_where_a_library_should_be(checked: Check, ideal_axis: Build) -> None:
    fmu = ideal_axis()
    with zipfile.ZipFile(fmu) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(fmu, "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, b"no code" if name.startswith("binaries/") else content)
    _, rows = checked(fmu)
    assert "no library" in _failed(rows)["platforms"]


# ---- Files that are no FMU


@pytest.mark.long
@pytest.mark.parametrize("content", [b"", b"garbage", b"PK\5\6" + bytes(18)])
def test_a_file_that_is_no_fmu_fails(checked: Check, tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "none.fmu"
    path.write_bytes(content)
    code, rows = checked(path)
    assert code == 1
    assert "this is no FMU" in _failed(rows)["archive"]


@pytest.mark.long
def test_an_attacking_archive_fails(checked: Check, ideal_axis: Build) -> None:
    fmu = ideal_axis()
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("../outside", b"x")
    _, rows = checked(fmu)
    assert "'../outside' leaves the folder" in _failed(rows)["archive"]


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("none.fmu", "FMU not found"),
        (".", "this is a folder"),
        ("ServoAxe", "neither an FMU file nor a model of the library"),
    ],
)
@pytest.mark.parametrize("command", ["check", "show"])
def test_nothing_to_check(axisrig: Call, command: str, word: str, text: str) -> None:
    code, out, err = axisrig("fmu", command, word)
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert text in err
    assert err.count("\n") == 1


@pytest.mark.long
def test_the_table_names_area_level_and_remedy(axisrig: Call, ideal_axis: Build) -> None:
    fmu = ideal_axis("stuck.fmu", FLAW="FORGETS")
    code, out, _ = axisrig("fmu", "check", fmu)
    assert code == 1
    assert "stuck.fmu: FAIL" in out
    assert "leave canGetAndSetFMUState out" in " ".join(out.split())


@pytest.mark.long
def test_what_an_fmu_prints_does_not_get_into_the_result(ideal_axis: Build) -> None:
    fmu = ideal_axis(FLAW="PRINTS")
    ended = subprocess.run(
        [sys.executable, "-m", "axisrig.bench.cli", "fmu", "check", str(fmu), "--json"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    (answer,) = json.loads(ended.stdout)["fmus"]
    assert answer["verdict"] == "warn"
    (found,) = [f for f in answer["findings"] if "standard output" in f["text"]]
    assert found["area"] == "call sequence"
    assert found["text"] == "100 lines on standard output, the first: a step"
    assert ended.stderr == f"trying out {fmu}\n"


@pytest.mark.long
def test_several_files_are_checked_one_after_the_other(axisrig: Call, ideal_axis: Build) -> None:
    good, bad = ideal_axis("good.fmu"), ideal_axis("bad.fmu", CRASH_IN="LOAD")
    code, out, _ = axisrig("fmu", "check", good, bad, "--json")
    assert code == 1
    assert [fmu["verdict"] for fmu in json.loads(out)["fmus"]] == ["warn", "FAIL"]
    shutil.rmtree(good.parent)
