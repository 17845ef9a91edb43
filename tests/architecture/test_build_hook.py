"""The hook of a build: what it asks for and does by the variables of the environment."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
COMPILE, SHIP = "AXISRIG_COMPILE", "AXISRIG_SHIP"
NEEDS = {"mypy[mypyc]", "setuptools"}


@pytest.fixture
def module() -> ModuleType:
    spec = spec_from_file_location("compile_hook", ROOT / "kernel/compile_hook.py")
    assert spec is not None
    assert spec.loader is not None
    found = module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def hook(module: ModuleType, root: Path = ROOT, target: str = "wheel", **config: Any) -> Any:
    return module.CompileHook(str(root), config, None, None, str(root), target)


def needs(found: Any) -> set[str]:
    return {text.partition(">")[0].partition("<")[0] for text in found.dependencies()}


def set_to(monkeypatch: pytest.MonkeyPatch, **values: str | None) -> None:
    for name in (COMPILE, SHIP):
        monkeypatch.delenv(name, raising=False)
    for name, value in values.items():
        if value is not None:
            monkeypatch.setenv(name, value)


@pytest.mark.parametrize(
    ("value", "target", "compiles"),
    [
        ("1", "wheel", True), (None, "wheel", False), ("", "wheel", False), ("0", "wheel", False),
        ("no", "wheel", False), ("11", "wheel", False), ("1", "sdist", False),
    ],
)  # fmt: skip
def test_only_a_wheel_with_the_variable_at_1_needs_a_compiler(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch, value: str | None, target: str,
    compiles: bool,
) -> None:  # fmt: skip
    set_to(monkeypatch, AXISRIG_COMPILE=value)
    assert needs(hook(module, target=target)) == (NEEDS if compiles else set())


@pytest.mark.parametrize(
    ("compile_", "ship", "target", "version"),
    [
        (None, None, "wheel", "standard"), ("0", None, "wheel", "standard"),
        ("", "1", "wheel", "standard"), (None, "1", "wheel", "standard"),
        ("1", None, "wheel", "editable"), ("1", "1", "wheel", "editable"),
        ("1", "1", "sdist", "standard"),
    ],
)  # fmt: skip
def test_nothing_is_compiled_otherwise(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, compile_: str | None,
    ship: str | None, target: str, version: str,
) -> None:  # fmt: skip
    """And the wheel stays one for every platform; an editable installation is never compiled."""
    set_to(monkeypatch, AXISRIG_COMPILE=compile_, AXISRIG_SHIP=ship)
    data: dict[str, Any] = {"force_include": {}}
    hook(module, tmp_path, target, compiled=["missing"]).initialize(version, data)
    assert data == {"force_include": {}}
    assert list(tmp_path.iterdir()) == []


def test_with_the_variable_a_module_that_is_missing_stops_the_build(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The wheel then is one of this platform."""
    set_to(monkeypatch, AXISRIG_COMPILE="1")
    data: dict[str, Any] = {"force_include": {}}
    found = hook(module, tmp_path, compiled=["missing"], interpreted=[], native=[])
    with pytest.raises(ValueError, match="compiled: missing is missing"):
        found.initialize("standard", data)
    assert (data["pure_python"], data["infer_tag"]) == (False, True)
    assert "tag" not in data


# The modules


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    for name in ("a/b.py", "a/a.py", "a/_private.py", "a/__init__.py", "a/c/d.py", "e.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


@pytest.mark.parametrize(
    ("compiled", "interpreted", "found"),
    [
        (["a"], [], ["a/a.py", "a/b.py"]),
        (["e.py", "a"], [], ["e.py", "a/a.py", "a/b.py"]),
        (["a", "a/c"], ["a/a.py"], ["a/b.py", "a/c/d.py"]),
        (["a/__init__.py"], [], ["a/__init__.py"]),
        ([], [], []),
    ],
)  # fmt: skip
def test_a_folder_stands_for_its_modules_and_not_for_those_below_it(
    module: ModuleType, sources: Path, compiled: list[str], interpreted: list[str],
    found: list[str],
) -> None:  # fmt: skip
    """In the order of the list, then of the names; what begins with an underscore is left out."""
    config = {"compiled": compiled, "interpreted": interpreted}
    assert module.compiled_modules(sources, config) == found


@pytest.mark.parametrize(
    ("compiled", "interpreted", "message"),
    [
        (["a", "x"], [], "pyproject.toml: compiled: x is missing"),
        (["a/c.py"], [], "pyproject.toml: compiled: a/c.py is missing"),
        (["a"], ["e.py", "a/c/d.py"], r"not in a compiled folder: \['a/c/d.py', 'e.py'\]"),
    ],
)
def test_an_entry_without_a_module_is_named(
    module: ModuleType, sources: Path, compiled: list[str], interpreted: list[str], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        module.compiled_modules(sources, {"compiled": compiled, "interpreted": interpreted})


def test_an_extension_in_c_has_the_name_of_its_package(module: ModuleType) -> None:
    """Each may include headers of the folders of all of them, each folder once, in order."""
    pytest.importorskip("setuptools")
    sources = ["kernel/axisrig/kernel/time/_x.c", "bench/axisrig/bench/bus/_y.c",
               "kernel/axisrig/kernel/time/_z.c"]  # fmt: skip
    found = module.native_extensions({"native": sources})
    assert [each.name for each in found] == [
        "axisrig.kernel.time._x", "axisrig.bench.bus._y", "axisrig.kernel.time._z",
    ]  # fmt: skip
    for each, source in zip(found, sources, strict=True):
        assert each.sources == [source]
        assert each.include_dirs == ["bench/axisrig/bench/bus", "kernel/axisrig/kernel/time"]
