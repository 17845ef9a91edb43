"""The Modelica library as a second, independent grammar reads it (pymoca), and OpenModelica's.

Source of the rules: Modelica Language Specification 3.6, 4.8 "Balanced Models" (an input of a
component that is no connector needs a binding in its declaration), 3.7 (operators with the form of
a function), 18.6 (annotations for graphics).
"""

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from axisrig.fmus import MODELS
from axisrig.fmus.build import LIBRARY

parser = pytest.importorskip(
    "pymoca.parser", reason="pymoca is not installed: pip install pymoca (a dependency of dev)"
)

pytestmark = pytest.mark.long
FILES = sorted(LIBRARY.rglob("*.mo"))
# Operators that a component must not hide by its name
OPERATORS = {"change", "delay", "der", "edge", "initial", "pre", "reinit", "sample", "terminal"}


class Library:
    """Classes by their full names, with what a class inherits and where a name leads."""

    def __init__(self, files: list[Path]) -> None:
        self.classes = {}
        for file in files:
            text = file.read_text(encoding="utf-8")
            tree = parser.parse(text)
            assert tree is not None, f"pymoca cannot read {file}"
            within = re.match(r"within\s*([\w.]*)\s*;", text)[1]
            node = tree
            for name in within.split(".") if within else ():
                node = node.classes[name]
            own = file.stem if file.name != "package.mo" else file.parent.name
            self._add(f"{within}.{own}".lstrip("."), node.classes[own])

    def _add(self, name: str, node) -> None:
        self.classes[name] = node
        for inner, child in node.classes.items():
            self._add(f"{name}.{inner}", child)

    def find(self, name: str, inside: str) -> str | None:
        """The full name of the class that `name` means inside another one; None: built in."""
        around = inside.split(".")
        while around:
            full = ".".join([*around, name])
            if full in self.classes:
                return full
            around.pop()
        return name if name in self.classes else None

    def components(self, name: str) -> dict[str, tuple]:
        """Components of a class with the class that declares each, inherited ones first."""
        node, found = self.classes[name], {}
        for clause in node.extends:
            base = self.find(str(clause.component), name)
            if base is not None:
                found |= self.components(base)
        return found | {key: (symbol, name) for key, symbol in node.symbols.items()}

    def kind(self, symbol, inside: str) -> tuple[str | None, str]:
        """Full name and kind (model, block, connector ...) of the class of a component."""
        full = self.find(str(symbol.type), inside)
        return full, self.classes[full].type if full else ""


def modified(arguments) -> set[str]:
    """Names that get a value or are modified by a list of modifiers."""
    return {
        str(argument.value.component)
        for argument in (arguments.arguments if arguments else ())
        if hasattr(argument.value, "component")
    }


def without_binding(library: Library) -> Iterator[str]:
    """Inputs of components, not connectors, that their declaration gives no value."""
    for name, node in library.classes.items():
        if node.type not in ("model", "block"):
            continue
        for key, (symbol, declared_in) in library.components(name).items():
            full, kind = library.kind(symbol, declared_in)
            if kind not in ("model", "block") or declared_in != name:
                continue
            for inner, (part, home) in library.components(full).items():
                is_connector = library.kind(part, home)[1] == "connector"
                bound = inner in modified(symbol.class_modification) or (
                    getattr(part.value, "value", part.value) is not None
                )
                if "input" in part.prefixes and not is_connector and not bound:
                    yield f"{name}: {key}.{inner}"


@pytest.fixture(scope="module")
def library() -> Library:
    return Library(FILES)


def test_an_independent_grammar_reads_every_class_of_every_model(library):
    assert set(MODELS) <= set(library.classes)
    assert len(library.classes) > len(FILES)


def test_no_input_of_a_component_waits_for_an_equation(library):
    assert list(without_binding(library)) == []


def test_such_an_input_would_be_found(tmp_path):
    """One bound in the declaration, one that is a connector, one that is neither."""
    package = tmp_path / "P" / "package.mo"
    package.parent.mkdir()
    package.write_text(
        """within;
package P
  connector C = input Real;
  block B
    input Real bound;
    input Real waits;
    C wired;
  end B;
  model M
    B b(bound = 1);
  equation
    b.waits = 2;
    b.wired = 3;
  end M;
end P;
"""
    )
    assert list(without_binding(Library([package]))) == ["P.M: b.waits"]


def test_no_component_hides_an_operator_of_the_language(library):
    assert not [
        f"{name}.{key}"
        for name, node in library.classes.items()
        for key in node.symbols
        if key in OPERATORS and node.symbols[key].type is not None
    ]


def test_pi_is_declared_once(library):
    homes = [name for name, node in library.classes.items() if "pi" in node.symbols]
    assert homes == ["AxisRig.Constants"]
    texts = [f for f in FILES if "3.14159" in f.read_text(encoding="utf-8")]
    assert [f.name for f in texts] == ["Constants.mo"]


def test_every_component_says_what_it_is(library):
    missing = []
    for name, node in library.classes.items():
        if node.type in ("model", "block", "connector") and not node.is_short_class_definition:
            missing += [
                f"{name}.{key}" for key, symbol in node.symbols.items() if not symbol.comment
            ]
    assert not missing


@pytest.mark.skipif(shutil.which("omc") is None, reason="omc (OpenModelica) is not on the PATH")
@pytest.mark.parametrize("model", MODELS)
def test_openmodelica_checks_the_model(model, tmp_path):
    """`checkModel` instantiates, and counts equations and variables."""
    script = tmp_path / "check.mos"
    script.write_text(
        f'loadFile("{(LIBRARY / "package.mo").as_posix()}");\ncheckModel({model});\n'
        "getErrorString();\n"
    )
    done = subprocess.run(
        ["omc", str(script)], capture_output=True, text=True, timeout=300, check=False
    )
    assert "completed successfully" in done.stdout, done.stdout
