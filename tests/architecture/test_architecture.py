"""Who imports whom: rooms, folders, oracles and judges."""

import ast
import re
from collections.abc import Iterable, Iterator

import pytest
from tests.architecture.sources import MODULES, PACKAGES, ROOT, imported_names, package_of, trees

# Left imports nothing of what is further right; several in one place may import each other.
ORDER: tuple[tuple[str, ...], ...] = (
    ("axisrig.kernel.time", "axisrig.kernel.errors", "axisrig.kernel.parameters"),
    ("axisrig.kernel.profiles", "axisrig.kernel.kinematics"),
    ("axisrig.kernel.nc",),
    ("axisrig.kernel.motion",),
    ("axisrig.kernel.measuring", "axisrig.kernel.distance"),
    ("axisrig.kernel.drives", "axisrig.kernel.plc"),
    ("axisrig.kernel.cosim",),
    ("axisrig.kernel.channel",),
    ("axisrig.bench.files",),
    (
        *("axisrig.bench.bus", "axisrig.bench.plan", "axisrig.bench.oracles"),
        "axisrig.bench.statistics",
    ),
    ("axisrig.bench.drive",),
    ("axisrig.bench.rig",),
    ("axisrig.bench.record",),
    ("axisrig.bench.machine",),
    ("axisrig.bench.judge",),
    ("axisrig.bench.campaign",),
    ("axisrig.reports",),
    ("axisrig.bench.tools",),
    ("axisrig.results",),
    ("axisrig.bench.cli",),
)
# These know nothing of each other
STRANGERS = (
    *("axisrig.bench.bus", "axisrig.bench.plan", "axisrig.bench.oracles"),
    "axisrig.bench.statistics",
)
# Packages that hold nothing of their own but what lies in their rooms
EMPTY = ("axisrig.kernel", "axisrig.bench")
# The rooms of the exporter, the same way
FMUS_ORDER = (
    "axisrig.fmus.reading.errors",
    "axisrig.fmus.reading",
    "axisrig.fmus.equations",
    "axisrig.fmus.writing",
)
MAY_IMPORT_FMUS = tuple(
    f"axisrig.bench.{room}" for room in ("rig", "machine", "campaign", "tools", "cli")
)
# What says how a run had to be may take these of the kernel: units of time, types of errors
NO_FORMULA = ("axisrig.kernel.time", "axisrig.kernel.errors")
# Who looks at what a run has left, and where all of that is made
JUDGES = ("axisrig.bench.judge", "axisrig.reports")
MAKERS = ("axisrig.kernel", "axisrig.bench.machine", "axisrig.bench.rig")
# The invariants of the scenarios judge facts and series
OF_SCENARIOS = tuple(
    f"axisrig.bench.{room}" for room in ("record", "oracles", "judge", "tools.scenarios")
)
INVARIANTS = ("oracle", "invariants", "limits", "states")
RANKS = {name: rank for rank, names in enumerate(ORDER) for name in names}


def _imports(module: str) -> Iterator[tuple[int, str]]:
    """Line and full name of everything a module imports, at any depth of its code."""
    is_package = MODULES[module].name == "__init__.py"
    for node in ast.walk(trees()[module]):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = module.split(".")
                kept = parts[: len(parts) - node.level + is_package]
                base = ".".join([*kept, *([base] if base else [])])
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                yield node.lineno, whole if whole in MODULES else base


def _place(module: str) -> str | None:
    """The entry of `ORDER` that a module belongs to: the longest one that it begins with."""
    parts = module.split(".")
    names = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    return next((name for name in names if name in RANKS), None)


def _direction_errors(module: str, imports: Iterable[tuple[int, str]]) -> list[str]:
    place = _place(module)
    errors = []
    for line, name in imports:
        top = package_of(name)
        if top not in PACKAGES:
            continue
        if top == "axisrig.fmus":
            fits = package_of(module) == "axisrig.fmus" or place in MAY_IMPORT_FMUS
        elif name in EMPTY:
            fits = place is not None
        else:
            other = _place(name)
            fits = place is not None and other is not None and RANKS[other] <= RANKS[place]
            fits &= other == place or not {place, other} <= set(STRANGERS)
        if not fits:
            errors.append(f"{module}:{line} imports {name}")
    return errors


def _outside(module: str, allowed: Iterable[str]) -> list[str]:
    """What a module imports of the product that is none of the names and lies in none of them."""
    inside = tuple(f"{name}." for name in allowed)
    names = {name for _, name in [*_imports(module), *imported_names(trees()[module])]}
    # `from a import b` counts as a.b; a alone says less
    names -= {name for name in names if any(other.startswith(f"{name}.") for other in names)}
    return sorted(n for n in names if package_of(n) in PACKAGES and not f"{n}.".startswith(inside))


@pytest.mark.long
def test_oracles_take_nothing_from_what_they_judge() -> None:
    for module in MODULES:
        if module.startswith("axisrig.bench.oracles"):
            assert _outside(module, ("axisrig.bench.oracles", *NO_FORMULA)) == [], module


def _made(module: str) -> list[str]:
    """What a module imports of those that make a run, units of time and types of errors apart."""
    made = tuple(f"{name}." for name in MAKERS)
    return [name for name in _outside(module, NO_FORMULA) if f"{name}.".startswith(made)]


def test_who_judges_reads_recordings() -> None:
    """No formula, and nothing alive: what a run had to show comes from the oracles."""
    found = {module: _made(module) for module in MODULES if module.startswith(JUDGES)}
    assert {module: names for module, names in found.items() if names} == {}


@pytest.mark.parametrize("name", INVARIANTS)
def test_the_invariants_of_the_scenarios_take_no_formula(name: str) -> None:
    module = f"axisrig.bench.tools.scenarios.{name}"
    assert _outside(module, (*OF_SCENARIOS, *NO_FORMULA)) == []


@pytest.mark.parametrize(
    ("text", "outside"),
    [
        ("from axisrig.kernel.time.clock import S", []),
        ("from axisrig.bench.oracles.interpolation import cubic", []),
        ("from axisrig.kernel.errors import UserError", []),
        ("from axisrig.kernel.measuring.run import RunRecord", ["RunRecord"]),
        ("from axisrig.bench.machine.machine import Machine", ["Machine"]),
        ("from axisrig.bench.rig import rotary", ["rotary"]),
        ("from axisrig.kernel.cosim.plant.axis import hermite", ["hermite"]),
        ("from axisrig.kernel.cosim.plant import axis", ["axis"]),
        ("import axisrig.kernel.motion.dynamics", ["dynamics"]),
        (
            "def inside():\n    from axisrig.kernel.motion.dynamics import axis_slopes",
            ["axis_slopes"],
        ),
    ],
)
def test_what_no_recording_holds_is_found(
    text: str, outside: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    judge = "axisrig.bench.judge.topics"
    monkeypatch.setitem(trees(), judge, ast.parse(text))
    assert [name.rpartition(".")[2] for name in _made(judge)] == outside


def test_imports_point_to_the_left() -> None:
    errors = [text for module in MODULES for text in _direction_errors(module, _imports(module))]
    assert errors == []


def test_every_module_has_a_place_in_the_order() -> None:
    inside = [name for name in MODULES if name not in EMPTY and package_of(name) != "axisrig.fmus"]
    assert [name for name in inside if _place(name) is None] == []


def _room(module: str) -> int:
    """Number of a room of the exporter; what stands in front of all rooms comes last."""
    names = [name for name in FMUS_ORDER if f"{module}.".startswith(f"{name}.")]
    return FMUS_ORDER.index(names[0]) if names else len(FMUS_ORDER)


def test_rooms_of_the_exporter_import_what_stands_before_them() -> None:
    errors = [
        f"{module}:{line} imports {name}"
        for module in MODULES
        if module.startswith("axisrig.fmus.")
        for line, name in _imports(module)
        if name.startswith("axisrig.fmus.") and _room(name) > _room(module)
    ]
    assert errors == []


def test_the_page_shows_the_rooms_in_this_order() -> None:
    page = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| `([a-z.]+)` \| \S", page, re.MULTILINE)
    shown = [(int(number), f"axisrig.{room}") for number, room in rows]
    assert shown == [(rank + 1, name) for rank, names in enumerate(ORDER) for name in names]
    among = re.search(r"where there are several; (.*) do not import each other", page)
    beside = re.search(r"imports nothing of the others;(.*)may import it", page, re.DOTALL)
    for found, names in ((among, STRANGERS), (beside, MAY_IMPORT_FMUS)):
        assert found is not None
        assert [f"axisrig.{name}" for name in re.findall(r"`(.+?)`", found[1])] == list(names)


@pytest.mark.parametrize(
    ("module", "imported", "fits"),
    [
        ("axisrig.kernel.nc.text.parser", "axisrig.kernel.errors", True),
        ("axisrig.kernel.errors", "axisrig.kernel.nc.text.parser", False),
        ("axisrig.kernel.channel.channel", "axisrig.bench.machine.machine", False),
        ("axisrig.bench.machine.machine", "axisrig.bench.cli.main", False),
        ("axisrig.bench.bus.can.load", "axisrig.bench.plan.plan", False),
        ("axisrig.bench.judge.metrics", "axisrig.bench.campaign.runner", False),
        ("axisrig.bench.cli.main", "axisrig.reports.build", True),
        ("axisrig.reports.build", "axisrig.bench.campaign.results.writer", True),
        ("axisrig.bench.machine.plants", "axisrig.fmus", True),
        ("axisrig.kernel.cosim.fmi.fmu", "axisrig.fmus.build", False),
        ("axisrig.fmus.build", "axisrig.kernel.errors", False),
        ("axisrig.fmus.build", "axisrig.fmus.reading.errors", True),
        ("axisrig.kernel.newcomer", "axisrig.kernel.errors", False),
        ("axisrig.kernel.time.clock", "numpy", True),
    ],
)
def test_the_rule_itself_tells_left_from_right(module: str, imported: str, fits: bool) -> None:
    assert (_direction_errors(module, [(1, imported)]) == []) is fits


def _children(package: str) -> dict[tuple[str, str], set[str]]:
    """Imports between the children of each folder of a package.

    A child is a subfolder with all below it, or the modules of the folder itself with its
    `__init__`, named ".". Returns (folder, child) -> children that it imports.
    """
    edges: dict[tuple[str, str], set[str]] = {}
    for module in MODULES:
        if package_of(module) != package:
            continue
        own = _folder(module)
        for _, name in _imports(module):
            other = _folder(name) if name in MODULES and package_of(name) == package else own
            common = 0
            while own[common : common + 1] == other[common : common + 1] and common < len(own):
                common += 1
            if own != other:
                ours, theirs = (
                    "".join(folder[common : common + 1]) or "." for folder in (own, other)
                )
                edges.setdefault((".".join(own[:common]), ours), set()).add(theirs)
    return edges


def _folder(module: str) -> list[str]:
    parts = module.split(".")
    return parts if MODULES[module].name == "__init__.py" else parts[:-1]


def _circles(edges: dict[tuple[str, str], set[str]]) -> list[str]:
    """Name each child of a folder that reaches itself by what it imports."""
    found = []
    for folder, child in edges:
        reached: set[str] = set()
        ahead = [child]
        while ahead:
            new = edges.get((folder, ahead.pop()), set()) - reached
            reached |= new
            ahead += new
        if child in reached:
            found.append(f"{folder}: {child} by {', '.join(sorted(reached - {child}))}")
    return sorted(found)


@pytest.mark.parametrize("package", PACKAGES)
def test_no_folder_imports_in_a_circle(package: str) -> None:
    """Words that two folders share are in a folder below both."""
    assert _circles(_children(package)) == []


def test_no_module_imports_in_a_circle() -> None:
    """Nor for types alone, so that each can be read after what it is made of."""
    edges: dict[tuple[str, str], set[str]] = {}
    for module in MODULES:
        names = {name for _, name in _imports(module) if name in MODULES}
        edges["axisrig", module] = names - {module}
    assert _circles(edges) == []


def test_a_circle_is_found() -> None:
    edges = {("a", "."): {"x"}, ("a", "x"): {"y"}, ("a", "y"): {"."}, ("b", "x"): {"."}}
    assert _circles(edges) == ["a: . by x, y", "a: x by ., y", "a: y by ., x"]
