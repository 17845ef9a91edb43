"""FMUs for other platforms, other compilers, and the same bytes every time."""

import importlib.util
import os
import struct
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from axisrig.fmus import PLATFORMS, BuildError
from axisrig.fmus import compiler as compilers
from axisrig.fmus.build import build, cache_key, place_in_cache
from axisrig.fmus.compiler import find_compiler, this_platform, universal_library

LIBRARY = """package Small
  model Plant
    input Real u(unit="N") "Force";
    output Real x(unit="m", start=0, fixed=true) "Travel";
  equation
    der(x) = u - x;
  end Plant;
end Small;
"""
# A stand-in for OpenModelica: it obeys the script as far as writing a file of the asked name.
OMC = """#!{python}
import re, sys, zipfile
if "--version" in sys.argv:
    print("OpenModelica stand-in")
    sys.exit()
script = open(sys.argv[1]).read()
call = r'buildModelFMU\\(([\\w.]+), version="([\\d.]+)".*fileNamePrefix="(\\w+)"\\)'
found = re.search(call, script)
model, version, name = found.groups()
if model.endswith("Broken"):
    print('"[Small/package.mo:3:5-3:9:writable] Error: Klass Broken not found.\\n"')
    sys.exit()
with zipfile.ZipFile(name + ".fmu", "w") as archive:
    archive.writestr("modelDescription.xml", model + " " + version)
"""

zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="the package ziglang is not installed"
)
# Windows is left to the command line: its first build makes the C runtime, one to two minutes.
QUICK = ("x86_64-linux", "aarch64-darwin", "x86_64-darwin")


@pytest.fixture
def library(tmp_path: Path) -> Path:
    root = tmp_path / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")
    return root


def binaries(fmu: Path) -> dict[str, bytes]:
    """Content of each file below `binaries`, by its folder."""
    with zipfile.ZipFile(fmu) as archive:
        return {
            Path(name).parent.name: archive.read(name)
            for name in archive.namelist()
            if name.startswith("binaries/")
        }


@zig
def test_one_fmu_holds_libraries_of_several_platforms(library, tmp_path):
    fmu = build("Small.Plant", tmp_path / "a.fmu", library, platforms=QUICK)
    found = binaries(fmu)
    assert set(found) == set(QUICK)
    assert found["x86_64-linux"][:4] == b"\x7fELF"
    for machine, cpu_type in (("aarch64", 0x0100000C), ("x86_64", 0x01000007)):
        assert struct.unpack("<2I", found[f"{machine}-darwin"][:8]) == (0xFEEDFACF, cpu_type)
    assert validate_fmu(str(fmu)) == []


@zig
def test_library_for_apple_silicon_is_signed(library, tmp_path):
    """arm64 refuses a library without at least an ad-hoc signature (load command 0x1d)."""
    fmu = build("Small.Plant", tmp_path / "a.fmu", library, platforms=["aarch64-darwin"])
    (data,) = binaries(fmu).values()
    (count,) = struct.unpack_from("<I", data, 16)
    offset, commands = 32, []
    for _ in range(count):
        command, size = struct.unpack_from("<2I", data, offset)
        commands.append(command)
        offset += size
    assert 0x1D in commands


@zig
def test_version_2_has_one_universal_library_for_both_machines_of_macos(library, tmp_path):
    fmu = build("Small.Plant", tmp_path / "a.fmu", library, fmi="2.0", platforms=QUICK)
    found = binaries(fmu)
    assert set(found) == {"linux64", "darwin64"}
    data = found["darwin64"]
    magic, count = struct.unpack_from(">2I", data)
    assert (magic, count) == (0xCAFEBABE, 2)
    for number, cpu_type in enumerate((0x0100000C, 0x01000007)):
        kind, _, offset, size, align = struct.unpack_from(">5I", data, 8 + 20 * number)
        assert kind == cpu_type
        assert offset % (1 << align) == 0
        assert struct.unpack_from("<2I", data, offset) == (0xFEEDFACF, cpu_type)
        assert offset + size <= len(data)


@pytest.mark.parametrize(
    "lengths", [(7, 20_000), (16_384 - 12, 5), (2 * 16_384 - 12, 16_384 - 12), (16_384 - 11, 1, 9)]
)
def test_universal_library_keeps_each_part_byte_by_byte(tmp_path, lengths):
    """Each begins with a page of 16 KiB of its own; one that fills its pages needs no other."""
    parts = [struct.pack("<3I", 0xFEEDFACF, kind, 3) + bytes(kind) for kind in lengths]
    files = [tmp_path / f"part{n}" for n in range(len(parts))]
    for file, part in zip(files, parts, strict=True):
        file.write_bytes(part)
    universal_library(files, tmp_path / "both")
    data = (tmp_path / "both").read_bytes()
    assert struct.unpack_from(">2I", data) == (0xCAFEBABE, len(parts))
    page = 16_384
    for number, part in enumerate(parts):
        kind, subtype, offset, size, align = struct.unpack_from(">5I", data, 8 + 20 * number)
        assert (kind, subtype, 1 << align) == (lengths[number], 3, page)
        assert offset == page * (1 + sum(-(-len(before) // page) for before in parts[:number]))
        assert data[offset : offset + size] == part


@zig
@pytest.mark.parametrize("fmi", ["3.0", "2.0"])
def test_same_sources_and_pinned_compiler_give_the_same_bytes(library, tmp_path, fmi):
    options = {"fmi": fmi, "platforms": QUICK, "compiler": "zig"}
    first = build("Small.Plant", tmp_path / "a" / "x.fmu", library, **options)
    second = build("Small.Plant", tmp_path / "another" / "folder" / "x.fmu", library, **options)
    assert first.read_bytes() == second.read_bytes()


@zig
def test_both_compilers_give_the_same_motion(load, library, tmp_path):
    if find_compiler().name != "cc":
        pytest.skip("no system cc to compare with")
    ends = []
    for compiler in ("cc", "zig"):
        plant = load(build("Small.Plant", tmp_path / compiler, library, compiler=compiler), u=2.0)
        for _ in range(100):
            plant.step(1e-3)
        ends.append(plant.x)
    assert ends[0] == pytest.approx(ends[1], rel=1e-14)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"fmi": "1.0"}, r"FMI version 1\.0 is not known; there are 3\.0, 2\.0"),
        ({"platforms": ["amiga"]}, "platform amiga is not known; there are x86_64-linux"),
        ({"compiler": "tcc"}, "compiler tcc is not known; there are cc, zig, omc"),
        ({"fmi": "2.0", "platforms": ["aarch64-linux"]}, "FMI 2.0 has no aarch64-linux"),
        ({"compiler": "omc", "platforms": ["x86_64-windows"]}, "OpenModelica builds for"),
    ],
)
def test_unknown_options_are_refused_with_what_there_is(library, tmp_path, options, text):
    with pytest.raises(BuildError, match=text):
        build("Small.Plant", tmp_path / "a.fmu", library, **options)


@pytest.mark.skipif(find_compiler().name != "cc", reason="there is no system cc")
def test_cc_builds_for_its_own_platform_only(library, tmp_path):
    other = next(name for name in PLATFORMS if name != this_platform().name)
    with pytest.raises(BuildError, match=f"not for {other}; zig does"):
        build("Small.Plant", tmp_path / "a.fmu", library, platforms=[other], compiler="cc")


@pytest.mark.parametrize("name", [None, "cc", "zig"])
@pytest.mark.parametrize("foreign", [(), (0,), (1,), (0, 2)])
def test_for_any_other_platform_it_is_zig_that_builds(monkeypatch, name, foreign):
    """Wherever in the list the other platform is."""
    monkeypatch.setattr(compilers, "find_compiler", lambda wanted=None: wanted)
    others = [one for one in PLATFORMS.values() if one is not this_platform()]
    wanted = [others[k] if k in foreign else this_platform() for k in range(3)]
    if foreign and name == "cc":
        with pytest.raises(BuildError, match=f"not for {others[foreign[0]].name}; zig does"):
            compilers.compiler_for(wanted, name)
    else:
        assert compilers.compiler_for(wanted, name) == ("zig" if foreign else name)


@zig
def test_cache_tells_versions_platforms_and_compilers_apart():
    model = "AxisRig.Drives.ServoAxis"
    options = ({}, {"fmi": "2.0"}, {"platforms": QUICK}, {"compiler": "zig"})
    keys = [cache_key(model, **option) for option in options]
    if find_compiler().name == "cc":
        assert len(set(keys)) == len(keys)
    assert cache_key(model, platforms=[this_platform().name]) == keys[0]
    assert keys[1][:24] in place_in_cache(model, fmi="2.0").name


# --- OpenModelica, played by a script that only writes a file ----------------------------------


@pytest.fixture
def omc(tmp_path, monkeypatch):
    folder = tmp_path / "bin"
    folder.mkdir()
    program = folder / "omc"
    program.write_text(OMC.replace("{python}", sys.executable), encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with a first line")
@pytest.mark.usefixtures("omc")
def test_omc_is_asked_for_the_model_and_version(library, tmp_path):
    fmu = build("Small.Plant", tmp_path / "out" / "a.fmu", library, fmi="2.0", compiler="omc")
    assert zipfile.ZipFile(fmu).read("modelDescription.xml") == b"Small.Plant 2.0"
    assert [p.name for p in fmu.parent.iterdir()] == ["a.fmu"]


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with a first line")
@pytest.mark.usefixtures("omc")
def test_what_omc_complains_about_is_in_the_error(library, tmp_path):
    with pytest.raises(BuildError, match="OpenModelica says: Klass Broken not found"):
        build("Small.Broken", tmp_path / "a.fmu", library, compiler="omc")


def test_a_missing_omc_is_an_error(library, tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(BuildError, match="omc is not on the PATH"):
        build("Small.Plant", tmp_path / "a.fmu", library, compiler="omc")
