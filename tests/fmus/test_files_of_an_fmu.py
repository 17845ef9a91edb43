"""Which files an FMU holds, where and how; the texts and libraries in it are of stand-ins."""

import struct
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus import build as building
from axisrig.fmus.build import CATALOGUE, DEFAULT_STEP_S, LIBRARY, build
from axisrig.fmus.compiler import PLATFORMS, Compiler, Platform
from axisrig.fmus.reading import ir
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.target import TARGET
from axisrig.fmus.writing import generate as writing

# <mach/machine.h>: the types of CPU of both machines of macOS
CPU = {"x86_64": 0x01000007, "aarch64": 0x0100000C}
OTHERS = {"documentation/index.html": b"<p>", "documentation/licenses/a.txt": b"free"}
HEADERS = {
    "3.0": {"fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"},
    "2.0": {"fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"},
}
RUNTIME = {"runtime.h", "equations.inc", "solver.inc", "slave.inc"}


def machine_code(target: Platform) -> bytes:
    head = struct.pack("<3I", 0xFEEDFACF, CPU[target.name.partition("-")[0]], 3)
    return head + target.name.encode()


class Parts:
    """What the parts of a build are asked for; `refused`: the platform that none is built for."""

    def __init__(self) -> None:
        self.compiled: list[tuple[Any, ...]] = []
        self.generated: list[tuple[Any, ...]] = []
        self.libraries: list[tuple[str, str, bool]] = []
        self.refused = ""

    def compile_model(self, model: str, library: Path, roots: Sequence[Path]) -> Any:
        self.compiled.append((model, library, roots))
        return SimpleNamespace(model=model)

    def generate(self, read: Any, step_s: float, fmi: str) -> Any:
        self.generated.append((read.model, step_s, fmi))
        return SimpleNamespace(
            identifier=read.model.replace(".", "_"), fmi=fmi, source="int m;\n",
            description="<\u00e4>\n", others=OTHERS,
        )  # fmt: skip

    def compile_library(
        self, compiler: Compiler, source: Path, library: Path, target: Platform, is_it: bool
    ) -> None:
        assert source.read_bytes() == b"int m;\n"
        if target.name == self.refused:
            raise BuildError(source.name, None, "the C compiler says: no")
        library.parent.mkdir(parents=True, exist_ok=True)
        library.write_bytes(machine_code(target))
        self.libraries.append((compiler.name, target.name, is_it))


@pytest.fixture
def parts(monkeypatch: pytest.MonkeyPatch) -> Parts:
    made = Parts()
    monkeypatch.setattr(ir, "compile_model", made.compile_model)
    monkeypatch.setattr(writing, "generate", made.generate)
    monkeypatch.setattr(building, "compile_library", made.compile_library)
    monkeypatch.setattr(building, "compiler_for", lambda *_: Compiler("any", (), "1"))
    monkeypatch.setattr(building, "this_platform", lambda: PLATFORMS["x86_64-linux"])
    return made


@pytest.fixture
def built(parts: Parts, tmp_path: Path) -> Callable[..., dict[str, bytes]]:
    """The files of an FMU of the model Small.Plant by name."""

    def make(**options: Any) -> dict[str, bytes]:
        path = build("Small.Plant", tmp_path / "out" / "a.fmu", **options)
        assert [one.name for one in path.parent.iterdir()] == ["a.fmu"]
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist()}

    return make


def libraries(files: dict[str, bytes]) -> dict[str, bytes]:
    return {
        name.removeprefix("binaries/"): data
        for name, data in files.items()
        if name.startswith("binaries/")
    }


def of_each_machine(data: bytes) -> dict[int, bytes]:
    """The parts of a universal library by their type of CPU (<mach-o/fat.h>)."""
    magic, count = struct.unpack_from(">2I", data)
    assert magic == 0xCAFEBABE
    entries = [struct.unpack_from(">5I", data, 8 + 20 * number) for number in range(count)]
    return {kind: data[begin : begin + size] for kind, _, begin, size, _ in entries}


# Libraries


@pytest.mark.parametrize(
    ("names", "places"),
    [
        ((), ["x86_64-linux/Small_Plant.so"]),
        (("aarch64-linux",), ["aarch64-linux/Small_Plant.so"]),
        (("x86_64-windows", "x86_64-linux"),
         ["x86_64-linux/Small_Plant.so", "x86_64-windows/Small_Plant.dll"]),
        (("x86_64-darwin", "aarch64-darwin"),
         ["aarch64-darwin/Small_Plant.dylib", "x86_64-darwin/Small_Plant.dylib"]),
        # Named twice, it is there once
        (("x86_64-darwin", "x86_64-darwin"), ["x86_64-darwin/Small_Plant.dylib"]),
    ],
)  # fmt: skip
def test_each_platform_has_its_own_library_and_nothing_else(
    built: Callable[..., dict[str, bytes]], names: Sequence[str], places: Sequence[str]
) -> None:
    """FMI 3.0.2, section 2.5.1.4: binaries/<architecture>-<system>/<modelIdentifier>.<ending>."""
    found = libraries(built(platforms=names))
    assert sorted(found) == places
    for place, data in found.items():
        assert data == machine_code(PLATFORMS[place.partition("/")[0]])


@pytest.mark.parametrize(
    ("names", "folders"),
    [
        ((), {"linux64": "so"}), (("x86_64-linux",), {"linux64": "so"}),
        (("x86_64-windows",), {"win64": "dll"}),
        (("x86_64-darwin",), {"darwin64": "dylib"}), (("aarch64-darwin",), {"darwin64": "dylib"}),
        (("aarch64-darwin", "x86_64-darwin"), {"darwin64": "dylib"}),
        (("aarch64-darwin", "x86_64-windows", "x86_64-linux"),
         {"darwin64": "dylib", "win64": "dll", "linux64": "so"}),
    ],
)  # fmt: skip
def test_fmi_2_has_one_library_of_macos_for_both_of_its_machines(
    built: Callable[..., dict[str, bytes]], names: Sequence[str], folders: dict[str, str]
) -> None:
    """Whichever of the two is asked for; what it was joined from is not in the FMU."""
    found = libraries(built(fmi="2.0", platforms=names))
    assert set(found) == {f"{folder}/Small_Plant.{end}" for folder, end in folders.items()}
    for name, data in found.items():
        folder = name.partition("/")[0]
        wanted = [one for one in PLATFORMS.values() if one.fmi2_folder == folder]
        if folder == "darwin64":
            parts = {CPU[one.name.partition("-")[0]]: machine_code(one) for one in wanted}
            assert len(parts) == 2
            assert of_each_machine(data) == parts
        else:
            assert [data] == [machine_code(one) for one in wanted]


@pytest.mark.parametrize("is_optimised", [True, False])
@pytest.mark.parametrize(("fmi", "macos"), [("3.0", ["x86_64-darwin"]), ("2.0", [])])
def test_all_libraries_are_compiled_with_one_compiler_and_the_same_optimisation(
    built: Callable[..., dict[str, bytes]],
    parts: Parts,
    is_optimised: bool,
    fmi: str,
    macos: Sequence[str],
) -> None:
    names = ["x86_64-windows", "aarch64-darwin", *macos]
    built(fmi=fmi, platforms=names, is_optimised=is_optimised)
    targets = {"x86_64-windows", "aarch64-darwin", "x86_64-darwin"}
    assert set(parts.libraries) == {("any", target, is_optimised) for target in targets}
    assert len(parts.libraries) == 3


def test_a_build_is_optimised_unless_somebody_asks_for_less(
    built: Callable[..., dict[str, bytes]], parts: Parts
) -> None:
    built()
    assert parts.libraries == [("any", "x86_64-linux", True)]


# Texts


@pytest.mark.parametrize(
    ("fmi", "own"),
    [
        ("3.0", {"fmi3.inc", "fmi3_absent.inc", "buildDescription.xml"}),
        ("2.0", {"fmi2.inc", "fmi2_absent.inc"}),
    ],
)
def test_sources_are_the_code_the_runtime_and_the_headers_of_the_version(
    built: Callable[..., dict[str, bytes]], fmi: str, own: set[str]
) -> None:
    """FMI 3.0 lists them in buildDescription.xml, FMI 2.0 in the model description."""
    files = built(fmi=fmi)
    names = {"Small_Plant.c", *RUNTIME, *own, *HEADERS[fmi]}
    sources = {name.removeprefix("sources/") for name in files if name.startswith("sources/")}
    assert sources == names
    assert set(files) == {
        *(f"sources/{name}" for name in names), "modelDescription.xml", *OTHERS,
        f"binaries/{'x86_64-linux' if fmi == '3.0' else 'linux64'}/Small_Plant.so",
    }  # fmt: skip
    for name in sources - HEADERS[fmi] - {"Small_Plant.c", "buildDescription.xml"}:
        assert files[f"sources/{name}"] == (TARGET / name).read_bytes()
    for name in HEADERS[fmi]:
        assert f"#ifndef {name.removesuffix('.h')}_h".encode() in files[f"sources/{name}"]


def test_a_build_description_names_the_library_and_its_only_source(
    built: Callable[..., dict[str, bytes]],
) -> None:
    text = built()["sources/buildDescription.xml"].decode()
    assert '<fmiBuildDescription fmiVersion="3.0">' in text
    assert '<BuildConfiguration modelIdentifier="Small_Plant">' in text
    assert text.count("<SourceFile ") == 1
    assert '<SourceFile name="Small_Plant.c"/>' in text


def test_texts_are_the_same_on_every_system(built: Callable[..., dict[str, bytes]]) -> None:
    """UTF-8, and lines that end with a line feed alone."""
    files = built()
    assert files["modelDescription.xml"] == b"<\xc3\xa4>\n"
    assert files["sources/Small_Plant.c"] == b"int m;\n"
    assert b"\r" not in files["sources/buildDescription.xml"]
    assert {name: files[name] for name in OTHERS} == OTHERS


def test_an_archive_depends_on_nothing_but_its_files(
    built: Callable[..., dict[str, bytes]], tmp_path: Path
) -> None:
    """Names in order, stored as they are, one date, one system and one set of rights."""
    names = list(built(platforms=["x86_64-windows", "x86_64-linux"]))
    assert names == sorted(names)
    with zipfile.ZipFile(tmp_path / "out" / "a.fmu") as archive:
        for entry in archive.infolist():
            assert (entry.compress_type, entry.create_system) == (zipfile.ZIP_STORED, 3)
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert entry.external_attr >> 16 == 0o644


# What is built and where it goes


def test_the_model_of_a_library_folder_uses_this_alone_and_a_file_the_library_of_axisrig(
    parts: Parts, tmp_path: Path
) -> None:
    file = tmp_path / "Ramp.mo"
    file.touch()
    path = tmp_path / "deep" / "er" / "a.fmu"
    assert build("Ramp", path, file) == path
    build("Small.Plant", path, tmp_path)
    build("AxisRig.Any", path)
    assert parts.compiled == [
        ("Ramp", file, (LIBRARY,)), ("Small.Plant", tmp_path, ()), ("AxisRig.Any", LIBRARY, ()),
    ]  # fmt: skip


@pytest.mark.parametrize("step_s", [None, 1e-6, 0.002])
def test_the_internal_step_is_that_of_the_call_of_the_catalogue_or_of_all_others(
    parts: Parts, tmp_path: Path, step_s: float | None
) -> None:
    """50 us where nobody says another."""
    models = {one.step_s: (name, one) for name, one in CATALOGUE.items()}
    assert len(models) > 1
    for name, model in models.values():
        parts.generated.clear()
        build(name, tmp_path / "a.fmu", step_s=step_s)
        assert parts.generated == [(name, model.step_s if step_s is None else step_s, "3.0")]
    parts.generated.clear()
    build("Small.Plant", tmp_path / "a.fmu", step_s=step_s, fmi="2.0")
    assert parts.generated == [("Small.Plant", 5e-5 if step_s is None else step_s, "2.0")]
    assert DEFAULT_STEP_S == 5e-5


def test_a_new_build_takes_the_place_of_the_former_one(
    parts: Parts, built: Callable[..., dict[str, bytes]]
) -> None:
    assert list(libraries(built())) == ["x86_64-linux/Small_Plant.so"]
    names = ["x86_64-windows"]
    assert list(libraries(built(platforms=names))) == ["x86_64-windows/Small_Plant.dll"]


@pytest.mark.parametrize("refused", ["x86_64-linux", "x86_64-windows"])
def test_a_build_that_fails_leaves_the_former_one_and_nothing_else(
    parts: Parts, tmp_path: Path, refused: str
) -> None:
    """Also where only the second of two platforms is refused."""
    path = build("Small.Plant", tmp_path / "out" / "a.fmu")
    good = path.read_bytes()
    parts.refused = refused
    for place in (path, tmp_path / "new" / "b.fmu"):
        with pytest.raises(BuildError, match=r"^Small_Plant\.c: the C compiler says: no$"):
            build("Small.Plant", place, platforms=["x86_64-linux", "x86_64-windows"])
    assert list(path.parent.iterdir()) == [path]
    assert list((tmp_path / "new").iterdir()) == []
    assert path.read_bytes() == good


@pytest.mark.parametrize("names", [["aarch64-linux"], ["x86_64-linux", "aarch64-linux"]])
def test_a_platform_that_fmi_2_does_not_have_is_refused_beside_one_that_it_has(
    parts: Parts, tmp_path: Path, names: Sequence[str]
) -> None:
    with pytest.raises(BuildError, match=r"FMI 2\.0 has no aarch64-linux"):
        build("Small.Plant", tmp_path / "a.fmu", fmi="2.0", platforms=names)
    assert parts.libraries == []
    assert list(tmp_path.iterdir()) == []
