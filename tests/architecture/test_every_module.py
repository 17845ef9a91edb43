"""What nobody may do: read the wall clock, sleep, draw unseeded numbers; size and docstrings."""

import ast
from collections.abc import Iterator

import pytest
from tests.architecture.sources import MODULES, Function, imported_names, trees

WALL_CLOCK = {"time", "datetime"}
# The command line hands it down; the watch over processes holds them to their limits
MAY_READ_WALL_CLOCK = (
    "axisrig.bench.cli.main",
    "axisrig.bench.cli.data_commands",
    "axisrig.bench.cli.outside",
    "axisrig.bench.cli.perf_command",
    "axisrig.bench.cli.pytest_results",
    "axisrig.bench.cli.scenario_command",
    "axisrig.bench.campaign.processes",
)
# Progress and the page of a run, beside the runs
MAY_START_THREADS = "axisrig.bench.cli.beside."
CONCURRENCY = {"threading", "asyncio", "concurrent", "sched", "_thread"}
STARTS_NOTHING = {"threading.get_ident"}  # the identity of the caller

MODULE_LINES_MAX, FUNCTION_LINES_MAX = 450, 70
# Module or module.function -> why it may be longer
LONG: dict[str, str] = {}


def test_wall_clock_and_threads_stay_outside() -> None:
    found = []
    for module, tree in trees().items():
        clocks = WALL_CLOCK if module not in MAY_READ_WALL_CLOCK else set()
        threads = CONCURRENCY if not module.startswith(MAY_START_THREADS) else set()
        forbidden = clocks | threads
        for line, name in imported_names(tree):
            if name.partition(".")[0] in forbidden and name not in STARTS_NOTHING:
                found.append(f"{module}:{line} imports {name}")
    assert found == []


def _dotted(node: ast.expr) -> str:
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def _calls(tree: ast.AST) -> Iterator[tuple[ast.Call, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            yield node, _dotted(node.func)


def test_nobody_sleeps() -> None:
    found = [
        f"{module}:{node.lineno}"
        for module, tree in trees().items()
        for node, name in _calls(tree)
        if name.rpartition(".")[2] == "sleep"
    ]
    assert found == []


def _unseeded(tree: ast.AST) -> list[int]:
    """Lines that draw from a generator nobody seeded."""
    lines = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module in ("random", "numpy.random"):
            names = {alias.name for alias in node.names}
            if not names <= {"Random", "Generator", "default_rng"}:
                lines.append(node.lineno)
    for node, name in _calls(tree):
        given = bool(node.args or node.keywords)
        if name in ("random.Random", "Random") or name.endswith("default_rng"):
            if not given:
                lines.append(node.lineno)
        elif name.startswith(("random.", "np.random.", "numpy.random.", "secrets.")) or name in (
            "uuid.uuid4",
            "uuid.uuid1",
            "os.urandom",
        ):
            lines.append(node.lineno)
    return lines


@pytest.mark.long
def test_every_random_number_is_seeded() -> None:
    found = [f"{name}:{line}" for name, tree in trees().items() for line in _unseeded(tree)]
    assert found == []


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("import random\nrandom.Random(7).random()", []),
        ("import random\nrandom.random()", [2]),
        ("import random\nrandom.Random()", [2]),
        ("from random import choice", [1]),
        ("np.random.default_rng(3)", []),
        ("np.random.default_rng()", [1]),
        ("np.random.normal()", [1]),
    ],
)
def test_the_search_for_unseeded_numbers_finds_them(text: str, lines: list[int]) -> None:
    assert _unseeded(ast.parse(text)) == lines


def _functions(tree: ast.AST, prefix: str = "") -> Iterator[tuple[str, Function]]:
    """Every function and method with its qualified name, nested ones included."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Function | ast.ClassDef):
            name = f"{prefix}{node.name}"
            if not isinstance(node, ast.ClassDef):
                yield name, node
            yield from _functions(node, f"{name}.")
        else:
            yield from _functions(node, prefix)


def _too_long() -> Iterator[tuple[str, int]]:
    for module, tree in trees().items():
        lines = len(MODULES[module].read_text(encoding="utf-8").splitlines())
        if lines > MODULE_LINES_MAX:
            yield module, lines
        for name, node in _functions(tree):
            count = (node.end_lineno or node.lineno) - node.lineno + 1
            if count > FUNCTION_LINES_MAX:
                yield f"{module}.{name}", count


def test_modules_and_functions_stay_short() -> None:
    assert [f"{name}: {lines}" for name, lines in _too_long() if name not in LONG] == []


def test_every_exemption_from_the_length_is_needed() -> None:
    assert set(LONG) <= {name for name, _ in _too_long()}


def _is_stub(node: Function) -> bool:
    """Whether a function only declares, as in a Protocol or an overload."""
    last = node.body[-1]
    return isinstance(last, ast.Expr) and (
        isinstance(last.value, ast.Constant) and last.value.value is ...
    )


def _undocumented(tree: ast.Module) -> Iterator[str]:
    if ast.get_docstring(tree) is None:
        yield "module"
    for node in tree.body:
        if not isinstance(node, Function | ast.ClassDef) or node.name.startswith("_"):
            continue
        if ast.get_docstring(node) is None:
            yield node.name
        for method in node.body if isinstance(node, ast.ClassDef) else []:
            if (
                isinstance(method, Function)
                and not method.name.startswith("_")
                and not _is_stub(method)
                and ast.get_docstring(method) is None
            ):
                yield f"{node.name}.{method.name}"


def test_everything_public_is_described() -> None:
    found = [
        f"{module}: {name}" for module, tree in trees().items() for name in _undocumented(tree)
    ]
    assert found == []
