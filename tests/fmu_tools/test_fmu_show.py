"""`axisrig fmu show` and `list`: what an FMU says about itself; nothing of its code runs."""

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.tools.fmu.binaries import find_binaries, folder_platform
from axisrig.bench.tools.fmu.place import find_fmu
from axisrig.bench.tools.fmu.show import read_fmu
from axisrig.fmus import CATALOGUE, MODELS

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Build = Callable[..., Path]


def _elf(machine: int, *, is_big: bool = False) -> bytes:
    order = ">" if is_big else "<"
    head = b"\x7fELF" + bytes([2, 2 if is_big else 1]) + bytes(10)
    return head + struct.pack(f"{order}HH", 3, machine) + bytes(40)


def _pe(machine: int) -> bytes:
    return b"MZ" + bytes(58) + struct.pack("<I", 64) + b"PE\0\0" + struct.pack("<H", machine)


def _mach_o(kind: int) -> bytes:
    return struct.pack("<II", 0xFEEDFACF, kind) + bytes(24)


def _universal(*kinds: int) -> bytes:
    head = struct.pack(">II", 0xCAFEBABE, len(kinds))
    return head + b"".join(struct.pack(">IIIII", kind, 0, 4096, 100, 12) for kind in kinds)


INTEL_MAC, ARM_MAC = 0x01000007, 0x0100000C
HEADERS = [
    ("linux64", ".so", _elf(62), "linux", ("x86_64",), True),
    ("x86_64-linux", ".so", _elf(62), "linux", ("x86_64",), True),
    ("aarch64-linux", ".so", _elf(183), "linux", ("aarch64",), True),
    ("x86_64-linux", ".so", _elf(183), "linux", ("aarch64",), False),
    ("x86_64-linux", ".so", _elf(21, is_big=True), "linux", ("machine 21",), False),
    ("win64", ".dll", _pe(0x8664), "windows", ("x86_64",), True),
    ("win32", ".dll", _pe(0x14C), "windows", ("x86",), True),
    ("aarch64-windows", ".dll", _pe(0xAA64), "windows", ("aarch64",), True),
    ("win64", ".dll", _elf(62), "linux", ("x86_64",), False),
    ("darwin64", ".dylib", _mach_o(INTEL_MAC), "darwin", ("x86_64",), True),
    ("aarch64-darwin", ".dylib", _mach_o(ARM_MAC), "darwin", ("aarch64",), True),
    ("darwin64", ".dylib", _mach_o(ARM_MAC), "darwin", ("aarch64",), False),
    ("darwin64", ".dylib", _universal(INTEL_MAC, ARM_MAC), "darwin", ("x86_64", "aarch64"), True),
    ("linux64", ".so", b"", "", (), False),
    ("linux64", ".so", b"MZ", "", (), False),
    ("linux64", ".so", b"\x7fELF", "", (), False),
    ("linux64", ".so", b"text, no code", "", (), False),
]


@pytest.mark.parametrize(("folder", "ending", "head", "system", "processors", "in_place"), HEADERS)
def test_a_header_tells_system_and_processors(
    tmp_path: Path,
    folder: str,
    ending: str,
    head: bytes,
    system: str,
    processors: tuple[str, ...],
    in_place: bool,
) -> None:
    place = tmp_path / "binaries" / folder
    place.mkdir(parents=True)
    (place / f"model{ending}").write_bytes(head)
    (place / f"helper{ending}").write_bytes(_elf(62))
    (found,) = find_binaries(tmp_path, "model")
    assert (found.folder, found.system, found.processors) == (folder, system, processors)
    assert found.is_in_place is in_place
    assert found.is_universal is (len(processors) > 1)


def test_folders_of_both_versions_name_the_same_platforms() -> None:
    assert folder_platform("win64") == folder_platform("x86_64-windows") == ("windows", "x86_64")
    assert folder_platform("linux64") == folder_platform("x86_64-linux")
    assert folder_platform("darwin64") == folder_platform("x86_64-darwin")


def test_the_library_of_this_platform_is_recognised(ideal_axis: Build) -> None:
    (found,) = read_fmu(ideal_axis()).binaries
    assert found.is_in_place


@pytest.mark.parametrize(
    ("head", "text"),
    [
        (_universal(INTEL_MAC, ARM_MAC), "universal: x86_64 + aarch64, darwin); runs on Intel and"),
        (_mach_o(INTEL_MAC), "(x86_64, darwin); not universal"),
    ],
)
def test_the_one_macos_folder_of_fmi2_is_explained(
    axisrig: Call, ideal_axis: Build, head: bytes, text: str
) -> None:
    fmu = ideal_axis()
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("binaries/darwin64/ideal.dylib", head)
    code, out, _ = axisrig("fmu", "show", fmu)
    assert code == 0
    assert text in out


@pytest.mark.long
def test_variables_structure_and_capabilities(axisrig: Call) -> None:
    code, out, err = axisrig("fmu", "show", "AxisRig.Drives.ServoAxis")
    assert (code, err) == (0, "")
    lines = {line.split()[0]: line for line in out.splitlines() if line.strip()}
    assert "3.0, co-simulation" in lines["FMI"]
    assert len(lines["sha256"].split()[1]) == 64
    for word in ("input", "continuous", "Float64", "m", "0.0", "Demand"):
        assert word in lines["reference_position"].split()
    assert "output" in lines["position"]
    assert "demand_position: depends on time, reference_position" in out
    assert "save and restore its state: yes" in out
    variables = read_fmu(find_fmu("AxisRig.Drives.ServoAxis")).description.modelVariables
    hidden = sum(each.causality in ("local", "independent") for each in variables)
    assert f"\n{hidden} variables, local ones and time, are not shown; --all shows them" in out


@pytest.mark.long
def test_all_variables(axisrig: Call) -> None:
    _, out, _ = axisrig("fmu", "show", "ServoAxis", "--all")
    assert " local " in out
    assert " independent " in out
    assert "not shown" not in out
    assert "not shown" not in out


def test_an_fmu_that_cannot_run_here_is_shown(axisrig: Call, ideal_axis: Build) -> None:
    def change(text: str) -> str:
        text = text.replace("<CoSimulation", "<ModelExchange")
        return text.replace(' canHandleVariableCommunicationStepSize="true"', "")

    code, out, _ = axisrig("fmu", "show", ideal_axis(change=change, place="mips-plan9"))
    assert code == 0
    assert "3.0, model exchange" in out
    assert "mips-plan9" in out


def test_foreign_text_does_not_steer_the_terminal(axisrig: Call, ideal_axis: Build) -> None:
    # XML allows these two: a control sequence introducer of one byte, and a change of direction
    fmu = ideal_axis(
        change=lambda t: t.replace('unit="m"', 'unit="m" description="a\x9b2J\u202eb"')
    )
    code, out, _ = axisrig("fmu", "show", fmu)
    assert code == 0
    assert "a 2J b" in out
    assert not {"\x9b", "\u202e"} & set(out)


@pytest.mark.parametrize("content", [b"", b"garbage"])
def test_a_file_that_is_no_fmu(axisrig: Call, tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "none.fmu"
    path.write_bytes(content)
    code, out, err = axisrig("fmu", "show", path)
    assert (code, out) == (2, "")
    assert "this is no FMU" in err


@pytest.mark.parametrize("text", ["<a/>", '<fmiModelDescription fmiVersion="9"/>', "<a><b/></a>"])
def test_a_description_that_is_none(axisrig: Call, ideal_axis: Build, text: str) -> None:
    code, out, err = axisrig("fmu", "show", ideal_axis(change=lambda _: text))
    assert (code, out) == (2, "")
    assert "the model description is rejected" in err
    assert err.count("\n") == 1


def test_a_promise_that_is_no_number(axisrig: Call, ideal_axis: Build) -> None:
    fmu = ideal_axis(
        change=lambda t: t.replace("<CoSimulation", '<CoSimulation fixedInternalStepSize="1 2"')
    )
    code, out, err = axisrig("fmu", "show", fmu)
    assert (code, out) == (2, "")
    assert "the model description is rejected: could not convert" in err


def test_list_names_every_model_with_its_step_and_whether_it_is_built(axisrig: Call) -> None:
    axisrig("fmu", "build", "AxisRig.Drives.ServoAxis")
    code, out, _ = axisrig("fmu", "list")
    assert code == 0
    lines = out.splitlines()
    assert [line.split()[0] for line in lines[: len(MODELS)]] == list(MODELS)
    servo = next(line for line in lines if line.startswith("AxisRig.Drives.ServoAxis "))
    step_us = CATALOGUE["AxisRig.Drives.ServoAxis"].step_s * 1e6
    assert servo.split()[1:4] == [f"{step_us:g}", "us", "built"]
    assert "Servo axis" in servo
    assert lines[-1].startswith("built FMUs are in ")
