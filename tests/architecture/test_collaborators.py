"""Nobody puts a collaborator into an object that is made: it comes in by constructor."""

import ast
from collections.abc import Iterator
from functools import cache

import pytest
from tests.architecture.sources import Function, trees

ROOMS = ("axisrig.kernel.", "axisrig.bench.")
# What stays, by module and target, with its reason
FOREIGN = "a parser, an interpreter or a node of a library that has no other way in"
_ARCHIVE, _WORKBOOK = "axisrig.kernel.cosim.fmi.archive", "axisrig.bench.plan.workbook"
_NETWORK, _TASK = "axisrig.bench.bus.can.canopen_sim", "axisrig.bench.machine.plc.task"
ALLOWED = {
    **{
        (module, f"parser.{name}"): FOREIGN
        for module in (_ARCHIVE, _WORKBOOK)
        for name in ("StartElementHandler", "EndElementHandler", "StartDoctypeDeclHandler")
    },
    (_NETWORK, "self.nmt.state_update"): FOREIGN,
    (_NETWORK, "self.emcy.emcy_received"): FOREIGN,
    (_NETWORK, "pdo_map.receive_condition"): FOREIGN,
    ("axisrig.kernel.cosim.fmi.slave", "fmu._call"): FOREIGN,
    ("axisrig.bench.cli.start", "sys.unraisablehook"): FOREIGN,
    (_TASK, "hli.ve"): "the values of this cycle",
    (_TASK, "self._hli.ve"): "the values of the first cycle",
    ("axisrig.kernel.channel.axes.independent", "mover.feed"): "of the motion that begins",
    ("axisrig.bench.campaign.progress", "self._bar.draw"): "a view that comes and goes",
}
DATA = ("dataclass", "NamedTuple", "Enum", "IntEnum", "StrEnum", "TypedDict")


def in_rooms() -> Iterator[tuple[str, ast.Module]]:
    for module, tree in trees().items():
        if module.startswith(ROOMS):
            yield module, tree


@cache
def with_behaviour() -> frozenset[str]:
    """Names of classes that are no plain record, enumeration or error."""
    found = set()
    for _, tree in in_rooms():
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                heads = [ast.unparse(n) for n in (*node.decorator_list, *node.bases)]
                if not any(head.startswith(DATA) or head.endswith("Error") for head in heads):
                    found.add(node.name)
    return frozenset(found)


def is_own(target: ast.Attribute) -> bool:
    return isinstance(target.value, ast.Name) and target.value.id in ("self", "cls")


def pairs(node: ast.AST) -> Iterator[tuple[ast.Attribute, ast.expr]]:
    """Attributes of other objects that a statement assigns, each with its value."""
    if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
        return
    for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
        places, values = [target], [node.value]
        if isinstance(target, ast.Tuple):
            is_pair = isinstance(node.value, ast.Tuple)
            places = list(target.elts)
            values = list(node.value.elts) if is_pair else [node.value] * len(places)
        for place, value in zip(places, values, strict=False):
            if isinstance(place, ast.Attribute) and not is_own(place):
                yield place, value


def is_collaborator(value: ast.expr, functions: set[str], given: set[str]) -> bool:
    """Whether a value does something when it is asked: a function, a method, an object.

    functions: of the module, methods behind `self.`. given: parameters that are called, or objects.
    """
    if isinstance(value, ast.Call):
        return ast.unparse(value.func) in {"partial", *with_behaviour()}
    return isinstance(value, ast.Lambda) or ast.unparse(value) in functions | given


def functions_of(tree: ast.Module) -> set[str]:
    found = {node.name for node in ast.walk(tree) if isinstance(node, Function)}
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            methods = {part.name for part in node.body if isinstance(part, Function)}
            found = found - methods | {f"self.{name}" for name in methods}
    return found


def given_to(function: Function) -> set[str]:
    words = {"Callable", *with_behaviour()}
    arguments = (*function.args.args, *function.args.kwonlyargs)
    return {a.arg for a in arguments if a.annotation and words & names_in(a.annotation)}


def names_in(annotation: ast.expr) -> set[str]:
    return {node.id for node in ast.walk(annotation) if isinstance(node, ast.Name)}


def put_from_outside(module: str, tree: ast.Module) -> set[tuple[str, str]]:
    functions = functions_of(tree)
    return {
        (module, ast.unparse(place))
        for function in ast.walk(tree)
        if isinstance(function, Function)
        for node in ast.walk(function)
        for place, value in pairs(node)
        if is_collaborator(value, functions, given_to(function))
    }


@pytest.mark.long
def test_nobody_puts_a_collaborator_into_an_object_that_is_made() -> None:
    found = {pair for module, tree in in_rooms() for pair in put_from_outside(module, tree)}
    assert found == set(ALLOWED)


def test_the_rule_finds_what_it_forbids() -> None:
    code = """
class A:
    def work(self): ...
    def connect(self, other, made):
        other.turn = self.work
        made.run = lambda: 0
        made.part, self.here = StateMachine(other), self.work
        made.height_mm = 3.0
    def give(self, to, part: StateMachine, act: Callable[[], None], size: int):
        to.part, to.act, to.size = part, act, size
"""
    found = put_from_outside("m", ast.parse(code))
    assert found == {("m", "other.turn"), ("m", "made.run"), ("m", "made.part")} | {
        ("m", "to.part"),
        ("m", "to.act"),
    }
