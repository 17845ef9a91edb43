"""What a compiled build puts into a wheel: the extensions of this build and no others."""

import json
import os
import sys
from collections.abc import Sequence
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

setuptools = pytest.importorskip("setuptools")
HOOK = Path(__file__).parents[2] / "kernel/compile_hook.py"
NATIVE = "kernel/axisrig/kernel/time/_line.c"


class Compiler:
    """Stands for mypyc and the compiler: an extension for each module, a file for each extension.

    calls: what mypyc was asked for. folders: where it and the compiler were called.
    """

    def __init__(self) -> None:
        self.calls: list[tuple[list[str], dict[str, Any]]] = []
        self.folders: list[Path] = []
        self.failure: Exception | None = None

    def mypycify(self, words: list[str], **options: Any) -> list[Any]:
        self.calls.append((words, options))
        self.folders.append(Path.cwd())
        modules = [Path(word) for word in words if word.endswith(".py")]
        names = [".".join(module.with_suffix("").parts[1:]) for module in modules]
        return [setuptools.Extension(name, [f"{name}.c"]) for name in names]

    def compile(self, command: Any) -> None:
        self.folders.append(Path.cwd())
        if self.failure is not None:
            raise self.failure
        for name in command.get_outputs():
            path = Path(name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> Compiler:
    from setuptools.command.build_ext import build_ext  # noqa: PLC0415  may be missing

    found = Compiler()

    def run(command: Any) -> None:
        found.compile(command)

    mypyc = SimpleNamespace(mypycify=found.mypycify)
    monkeypatch.setitem(sys.modules, "mypyc.build", mypyc)  # type: ignore[arg-type]
    monkeypatch.setattr(build_ext, "run", run)
    monkeypatch.setenv("AXISRIG_COMPILE", "1")
    monkeypatch.delenv("AXISRIG_SHIP", raising=False)
    monkeypatch.setenv("LDSHARED", "cc -shared")
    return found


@pytest.fixture
def hook() -> ModuleType:
    spec = spec_from_file_location("compile_hook", HOOK)
    assert spec is not None
    assert spec.loader is not None
    found = module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A project of three modules."""
    folder = tmp_path / "kernel/axisrig/kernel/time"
    folder.mkdir(parents=True)
    for name in ("clock", "heap", "phases"):
        (folder / f"{name}.py").touch()
    return tmp_path


def built(
    hook: ModuleType, root: Path, *modules: str, native: Sequence[str] = (), **included: str
) -> dict[str, Any]:
    """What a build of these modules of `root` asks of hatchling; included: what was in before."""
    paths = [f"kernel/axisrig/kernel/time/{name}.py" for name in modules]
    config = {"compiled": paths, "interpreted": [], "native": native}
    data: dict[str, Any] = {"force_include": included}
    found = hook.CompileHook(str(root), config, None, None, str(root), "wheel")
    found.initialize("standard", data)
    return data


def modules_in(data: dict[str, Any]) -> list[str]:
    """The modules of the extensions of a wheel, in its order, without the tag of Python."""
    return [place.partition(".")[0] for place in data["force_include"].values()]


def test_a_module_that_is_compiled_no_more_has_no_extension_in_the_next_wheel(
    hook: ModuleType, compiler: Compiler, root: Path
) -> None:
    """An extension that is left hides the source of its module."""
    time = "axisrig/kernel/time"
    assert modules_in(built(hook, root, "clock", "heap", native=[NATIVE])) == [
        f"{time}/_line", f"{time}/clock", f"{time}/heap",
    ]  # fmt: skip
    assert modules_in(built(hook, root, "heap")) == [f"{time}/heap"]
    assert modules_in(built(hook, root, "phases", "heap")) == [f"{time}/heap", f"{time}/phases"]
    assert modules_in(built(hook, root, native=[NATIVE])) == [f"{time}/_line"]


def test_each_extension_is_a_file_that_goes_beside_its_source(
    hook: ModuleType, compiler: Compiler, root: Path
) -> None:
    """What others put into the wheel stays there."""
    data = built(hook, root, "clock", native=[NATIVE], other="axisrig/other")
    assert data["force_include"].pop("other") == "axisrig/other"
    assert len(data["force_include"]) == 2
    for file, place in data["force_include"].items():
        assert Path(file).is_file()
        assert Path(file) == root / "out/compiled/lib" / place
        assert place.startswith("axisrig/kernel/time/")
    assert (data["pure_python"], data["infer_tag"]) == (False, True)
    assert "tag" not in data
    assert os.environ["LDSHARED"] == "cc -shared"


def test_mypyc_gets_the_modules_in_order_and_the_settings_of_the_project(
    hook: ModuleType, compiler: Compiler, root: Path
) -> None:
    built(hook, root, "phases", "clock")
    ((words, options),) = compiler.calls
    time = "kernel/axisrig/kernel/time"
    assert words == ["--config-file=pyproject.toml", f"{time}/phases.py", f"{time}/clock.py"]
    assert options["group_name"] == "axisrig.kernel._compiled"
    assert Path(options["target_dir"]) == root / "out/compiled/c"


@pytest.mark.parametrize("failure", [None, RuntimeError("no compiler")])
def test_a_build_works_in_the_folder_of_the_project_and_leaves_it(
    failure: Exception | None, hook: ModuleType, compiler: Compiler, root: Path
) -> None:
    here, compiler.failure = Path.cwd(), failure
    if failure is None:
        built(hook, root, "clock")
    else:
        with pytest.raises(RuntimeError, match="no compiler"):
            built(hook, root, "clock")
    assert compiler.folders == [root, root]
    assert Path.cwd() == here


@pytest.mark.parametrize("ship", ["1", "0", ""])
def test_a_wheel_for_others_has_the_models_and_the_tag_of_an_old_glibc(
    ship: str, hook: ModuleType, compiler: Compiler, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """manylinux_2_28 of PEP 600 is glibc 2.28; extensions go in beside the models."""
    monkeypatch.setenv("AXISRIG_SHIP", ship)
    monkeypatch.setattr(hook, "shipped_fmus", lambda _: {"a.fmu": "axisrig/fmus/shipped/a.fmu"})
    data = built(hook, root, "clock")
    fmus = [place for place in data["force_include"].values() if place.endswith(".fmu")]
    assert len(data["force_include"]) - len(fmus) == 1
    if ship == "1":
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        assert data["tag"] == f"{python}-{python}-manylinux_2_28_x86_64"
        assert not data["infer_tag"]
        assert fmus == ["axisrig/fmus/shipped/a.fmu"]
        assert os.environ["LDSHARED"].endswith("ziglang cc -shared -target x86_64-linux-gnu.2.28")
    else:
        assert (data.get("tag"), data["infer_tag"], fmus) == (None, True, [])
        assert os.environ["LDSHARED"] == "cc -shared"


def test_shipped_models_have_the_key_of_their_sources_and_the_hash_of_their_file(
    hook: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def build(model: str, path: Path, *, compiler: str) -> Path:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(f"{model} by {compiler}".encode())
        return path

    monkeypatch.setattr("axisrig.fmus.build.MODELS", ("Lib.Slides.Slide", "Lib.Probe"))
    monkeypatch.setattr("axisrig.fmus.build.build", build)
    monkeypatch.setattr("axisrig.fmus.build.source_key", lambda model: f"key of {model}")
    files = hook.shipped_fmus(tmp_path)
    assert {Path(file).name: place for file, place in files.items()} == {
        name: f"axisrig/fmus/shipped/{name}" for name in ("Slide.fmu", "Probe.fmu", "keys.json")
    }
    assert all(Path(file).is_file() for file in files)
    (keys,) = [Path(file) for file in files if file.endswith("keys.json")]
    assert json.loads(keys.read_text(encoding="utf-8")) == {
        model: {
            "file": f"{model.rpartition('.')[2]}.fmu",
            "key": f"key of {model}",
            "sha256": sha256(f"{model} by zig".encode()).hexdigest(),
        }
        for model in ("Lib.Slides.Slide", "Lib.Probe")
    }
