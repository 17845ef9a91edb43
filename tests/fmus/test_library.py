"""The Modelica library as text: every class documented, every file in its package's order."""

import re
from pathlib import Path

import pytest
from fmpy import read_model_description

from axisrig.fmus import MODELS, ensure_built
from axisrig.fmus.build import LIBRARY

FILES = sorted(LIBRARY.rglob("*.mo"))


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.relative_to(LIBRARY).as_posix())
def test_class_is_documented_and_within_its_package(file: Path):
    text = file.read_text(encoding="utf-8")
    inside = file.parent if file.name != "package.mo" else file.parent.parent
    names = (
        ()
        if file.parent == LIBRARY and file.name == "package.mo"
        else (LIBRARY.name, *inside.relative_to(LIBRARY).parts)
    )
    assert text.startswith(f"within {'.'.join(names)};" if names else "within;")
    assert "Documentation(info=" in text
    own = file.stem if file.name != "package.mo" else file.parent.name
    assert re.search(
        rf'^(partial )?(package|model|block|connector|function) {own} "[^"]+"', text, re.M
    )


@pytest.mark.parametrize("order", sorted(LIBRARY.rglob("package.order")), ids=str)
def test_package_order_lists_the_classes(order: Path):
    listed = set(order.read_text(encoding="utf-8").split())
    folder = order.parent
    found = {p.stem for p in folder.glob("*.mo")} - {"package"}
    found |= {p.name for p in folder.iterdir() if (p / "package.mo").is_file()}
    inner = re.findall(
        r"^  (?:connector|model|block|function) (\w+)(?= |\n)",
        (folder / "package.mo").read_text(encoding="utf-8"),
        re.M,
    )
    assert listed == found | set(inner)


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.relative_to(LIBRARY).as_posix())
def test_every_real_has_a_unit(file: Path):
    """`Real` stands only with a unit; everything else uses a type of Units."""
    for line in file.read_text(encoding="utf-8").splitlines():
        if re.search(r"\bReal\b", line) and "<" not in line:
            assert "unit =" in line, line


# A declaration, with what follows it up to its end, strings left out
DECLARED = re.compile(
    r"^  (?P<words>(?:final |replaceable |redeclare |constant |parameter |discrete )*)"
    r"(?P<type>[A-Z][\w.]*)(?:\[[^\]]*\])? (?P<name>\w+)(?P<rest>[^;]*);",
    re.M,
)


def declarations(file: Path) -> list[re.Match[str]]:
    """The components that a class declares, before its equations."""
    text = re.sub(r'"(?:[^"\\]|\\.)*"', '""', file.read_text(encoding="utf-8"))
    head = re.split(r"^(?:initial )?equation|^algorithm|^  annotation\(", text, flags=re.M)[0]
    return list(DECLARED.finditer(head))


def is_drawn(file: Path, found: re.Match[str]) -> bool:
    """Whether a component is a connector or a block."""
    kind = found["type"]
    inside = LIBRARY.joinpath(*kind.split(".")).with_suffix(".mo").is_file()
    beside = (file.parent / f"{kind}.mo").is_file()
    return kind.startswith("Interfaces.") or inside or beside


MODEL_FILES = [
    f for f in FILES if re.search(r"^(partial )?(model|block) ", f.read_text("utf-8"), re.M)
]


@pytest.mark.parametrize("file", MODEL_FILES, ids=lambda f: f.relative_to(LIBRARY).as_posix())
def test_a_model_can_be_drawn(file: Path):
    """An icon of its own or of the package Icons; a place for each connector and component."""
    text = file.read_text(encoding="utf-8")
    assert "\n    Icon(graphics = {" in text or "\n  extends Icons." in text
    before = text.partition("\nprotected\n")[0]
    for found in declarations(file):
        is_hidden_signal = found["type"].startswith("Interfaces.") and (
            re.search(rf"\b{found['name']}\b", before) is None
        )
        if is_drawn(file, found) and not is_hidden_signal:
            assert "Placement(transformation(" in found["rest"], found["name"]


@pytest.mark.parametrize("file", MODEL_FILES, ids=lambda f: f.relative_to(LIBRARY).as_posix())
def test_a_parameter_is_in_a_group_of_the_dialog(file: Path):
    for found in declarations(file):
        if "parameter " in found["words"] and "final " not in found["words"]:
            assert "Dialog(group = " in found["rest"], found["name"]


def test_the_library_names_version_date_and_licence():
    text = (LIBRARY / "package.mo").read_text(encoding="utf-8")
    project = (LIBRARY.parents[3] / "pyproject.toml").read_text(encoding="utf-8")
    assert (
        re.search(r'version = "([^"]+)"', text)[1]
        == re.search(r'^version = "([^"]+)"', project, re.M)[1]
    )
    assert re.search(r'versionDate = "\d{4}-\d\d-\d\d"', text)
    assert "SPDX-License-Identifier: Apache-2.0" in text
    guide = (LIBRARY / "UsersGuide.mo").read_text(encoding="utf-8")
    for chapter in ("Concept", "Conventions", "Contact", "ReleaseNotes"):
        assert f'  class {chapter} "' in guide


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.relative_to(LIBRARY).as_posix())
def test_model_with_equations_names_its_source(file: Path):
    text = file.read_text(encoding="utf-8")
    components = ("Drives", "Mechanics", "Sensors", "Workpieces")
    physical = file.parent.name in components and file.name != "package.mo"
    if physical and file.stem != "ServoAxis" and "\npartial " not in text:
        for word in ("Equation", "Assumption", "Limit", "Source:"):
            assert word in text, word


@pytest.mark.parametrize("model", MODELS)
def test_every_declared_parameter_can_be_set(model):
    """A compiler may fix a parameter that decides an if; such a model must be written otherwise."""
    settable = {
        v.name
        for v in read_model_description(str(ensure_built(model))).modelVariables
        if v.causality == "parameter"
    }

    def declared(name: str) -> set[str]:
        text = LIBRARY.parent.joinpath(*name.split(".")).with_suffix(".mo").read_text("utf-8")
        return set(re.findall(r"^  parameter [\w.]+ (\w+)", text, re.M))

    assert declared(model) <= settable
    if any(name.startswith("workpiece.") for name in settable):
        workpiece = LIBRARY / "Workpieces" / "Workpiece.mo"
        parts = re.findall(r"^  ([A-Z]\w+) (\w+)[(;]", workpiece.read_text("utf-8"), re.M)
        for kind, part in parts:
            found = declared(f"AxisRig.Workpieces.{kind}")
            assert {f"workpiece.{part}.{name}" for name in found} <= settable


def test_readme_names_every_input_output_and_parameter():
    words = set(
        re.findall(r"`(\w+)`", (LIBRARY.parents[2] / "README.md").read_text(encoding="utf-8"))
    )
    for model in MODELS:
        description = read_model_description(str(ensure_built(model)))
        shown = {v.name for v in description.modelVariables if v.causality != "local"}
        others = ("y_", "z_", *(f"j{k}_" for k in range(2, 7)))  # "the same for"
        shown -= {"time", *(n for n in shown if n.startswith(others) or "." in n)}
        assert shown <= words
