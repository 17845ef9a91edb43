"""Modules that mypyc compiles: what it would only complain about in C, or at run time."""

import ast
import tomllib
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest
from tests.architecture.sources import MODULES, imported_names

ROOT = Path(__file__).parents[2]
# Of gcc and clang; mypyc puts an underscore before the name of an attribute
WORDS = (
    *("_alignof", "_asm", "_attribute", "_auto_type", "_complex", "_const", "_extension", "_imag"),
    *("_inline", "_int128", "_label", "_real", "_restrict", "_signed", "_thread", "_typeof"),
    "_volatile",
)


def _hook() -> Any:
    spec = spec_from_file_location("compile_hook", ROOT / "kernel/compile_hook.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _settings() -> dict[str, Any]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    hook: dict[str, Any] = settings["tool"]["hatch"]["build"]["targets"]["wheel"]["hooks"]["custom"]
    return hook


def _compiled() -> list[str]:
    found: list[str] = _hook().compiled_modules(ROOT, _settings())
    return found


def _classes() -> Iterator[tuple[str, ast.ClassDef]]:
    for path in _compiled():
        for node in ast.walk(ast.parse((ROOT / path).read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                yield path, node


def _is_data(node: ast.ClassDef) -> bool:
    """Whether names in the body of a class are fields or members."""
    words = " ".join(map(ast.unparse, [*node.bases, *node.decorator_list]))
    return any(word in words for word in ("dataclass", "Enum", "Flag", "NamedTuple", "Protocol"))


def test_the_list_names_modules_that_exist_and_leaves_some_out() -> None:
    modules = _compiled()
    assert len(modules) == len(set(modules)) > 100
    assert not set(modules) & set(_settings()["interpreted"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"compiled": ["kernel/axisrig/kernel/tmie"]}, "tmie is missing"),
        ({"interpreted": ["kernel/axisrig/kernel/errors.py"]}, "not in a compiled folder"),
    ],
)
def test_an_entry_that_does_not_exist_stops_the_build(
    change: dict[str, list[str]], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        _hook().compiled_modules(ROOT, {**_settings(), **change})


def test_what_is_written_in_c_has_types_and_no_compiled_rival() -> None:
    sources = [ROOT / source for source in _settings()["native"]]
    assert {source.name for source in sources} == {
        path.name for path in ROOT.glob("*/axisrig/**/_*.c")
    }
    for source in sources:
        assert source.with_suffix(".pyi").exists()
        assert not source.with_suffix(".py").exists()


def test_class_variables_are_declared_as_such() -> None:
    plain = [
        f"{path}: {node.name}.{ast.unparse(target)}"
        for path, node in _classes()
        if not _is_data(node)
        for statement in node.body
        if isinstance(statement, ast.Assign)
        for target in statement.targets
        if ast.unparse(target) != "__slots__"
    ]
    assert plain == []


def test_fields_outside_the_constructor_have_no_default_on_the_class() -> None:
    """A field with `default` and without `init` is only an attribute of the class."""
    found = [
        f"{path}: {node.name}.{ast.unparse(call)}"
        for path, node in _classes()
        for call in ast.walk(node)
        if isinstance(call, ast.Call) and ast.unparse(call.func) == "field"
        if {"default", "init"} <= {word.arg for word in call.keywords}
    ]
    assert found == []


def test_no_attribute_becomes_a_word_of_the_c_compiler() -> None:
    clashes = {
        f"{path}: {node.name}.{part.attr}"
        for path, node in _classes()
        for part in ast.walk(node)
        if isinstance(part, ast.Attribute) and part.attr in WORDS
    }
    assert clashes == set()


def _native() -> set[str]:
    """Full names of the classes that no interpreted class may derive from."""
    free = ("Enum", "Flag", "NamedTuple", "Protocol", "Error", "allow_interpreted_subclasses")
    found = set()
    for path, node in _classes():
        words = " ".join(map(ast.unparse, [*node.bases, *node.decorator_list]))
        if not any(word in words for word in free):
            module = path.split("/", 1)[1].removesuffix(".py").replace("/", ".")
            found.add(f"{module.removesuffix('.__init__')}.{node.name}")
    return found


@pytest.mark.long
def test_no_interpreted_class_derives_from_a_compiled_one() -> None:
    native, compiled = _native(), {str(ROOT / path) for path in _compiled()}
    assert native
    wrong = []
    for path in MODULES.values():
        if str(path) in compiled:
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        known = {whole.rpartition(".")[2]: whole for _, whole in imported_names(tree)}
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                bases = {known.get(ast.unparse(base), "") for base in node.bases}
                wrong += [f"{path.name}: {node.name}({base})" for base in bases & native]
    assert wrong == []
