"""The equations of one model in the order in which they are computed.

Layout: the solve representation has a vector y (states first, then everything that follows from
them at the same instant) and a vector p (parameters, inputs, discrete variables, their previous
values, relation memory). Each relation has a function whose sign decides it; between events its
value rests in p.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fmus.expressions import (
    COMPARE,
    Expr,
    NotAffineError,
    UnsupportedError,
    parameter,
    read_program,
    solve_for,
)
from fmus.ir import Ir, Source
from fmus.support import at, refuse_steps_in_time, refuse_unknown_slots, refuse_unsupported

# How a relation reads its function at exactly zero, as runtime.h has it.
AT_ZERO: Mapping[str, str] = {
    "NonPositive": "ZERO_IS_TRUE",
    "Positive": "ZERO_IS_FALSE",
    "Previous": "ZERO_KEEPS",
}


@dataclass(frozen=True)
class Assignment:
    """target := value. target: "y" or "p" and the slot. place: where the equation stands."""

    vector: str
    index: int
    value: Expr
    place: Source | None


@dataclass(frozen=True)
class Relation:
    """function < 0 means true; the value rests in p[memory]. at_zero: a word of runtime.h."""

    function: Expr
    memory: int
    at_zero: str
    place: Source | None


@dataclass(frozen=True)
class Assertion:
    """The simulation ends with `message` when `failed` is true after an event."""

    failed: Expr
    message: str
    place: Source | None


@dataclass(frozen=True)
class System:
    """All programs of a model.

    derivatives: of state 0..n-1, target "y" = the state. algebraics: everything else in y, in an
    order in which each needs only earlier ones. initial: parameters that follow from others, and
    initial equations. runtime: discrete variables without memory, in order. updates: discrete
    equations, all from one snapshot; `whens` of them belong to when-clauses and rest at the start.
    previous: (slot of pre(v), "y" or "p", slot of v).
    """

    y_count: int
    p_count: int
    derivatives: Sequence[Assignment]
    algebraics: Sequence[Assignment]
    initial: Sequence[Assignment]
    runtime: Sequence[Assignment]
    updates: Sequence[Assignment]
    whens: Sequence[Assignment]
    previous: Sequence[tuple[int, str, int]]
    relations: Sequence[Relation]
    assertions: Sequence[Assertion]

    @property
    def state_count(self) -> int:
        """Number of continuous states."""
        return len(self.derivatives)


def read_system(ir: Ir) -> System:
    """Read all programs and refuse what has no meaning here.

    Raises BuildError with the place of the construct.
    """
    refuse_unsupported(ir)
    solve = ir.solve
    layout, discrete, initial = solve["solve_layout"], solve["discrete"], solve["initialization"]
    runtime = discrete["runtime_assignment_plan"]
    offset = discrete["rhs_plan"]["output_count"]
    system = System(
        y_count=solve["layout"]["y_scalars"],
        p_count=solve["layout"]["p_scalars"],
        derivatives=_derivatives(ir),
        algebraics=_algebraics(ir, layout["state_scalar_count"]),
        initial=_targeted(ir, initial["update_plan"], initial["update_targets"]),
        runtime=_targeted(ir, runtime, discrete["runtime_assignment_targets"]),
        updates=_targeted(ir, discrete["rhs_plan"], discrete["update_targets"]),
        whens=_targeted(
            ir, discrete["guarded_assignment_plan"], discrete["update_targets"][offset:]
        ),
        previous=[
            (binding["dest_p_index"], *_slot(binding["source"]))
            for binding in layout["pre_param_bindings"]
        ],
        relations=_relations(ir),
        assertions=_assertions(ir),
    )
    if ir.dae["systems"]["events"]["time_events"]:
        system = _with_time_relations(ir, system)
    _check(ir, system)
    return system


def _check(ir: Ir, system: System) -> None:
    """Refuse values that the runtime would not keep as the compiler means them."""
    continuous = [(row.value, row.place) for row in (*system.derivatives, *system.algebraics)]
    refuse_steps_in_time(ir, continuous)
    rows = (*system.initial, *system.runtime, *system.updates, *system.whens)
    everything = [(row.value, row.place) for row in rows]
    everything += [(relation.function, relation.place) for relation in system.relations]
    known = {row.index for row in rows if row.vector == "p"}
    known |= {slot for slot, _, _ in system.previous}
    known |= {relation.memory for relation in system.relations}
    for binding in ir.solve["layout"]["bindings"].values():
        vector, index = _slot(binding)
        known |= {index} if vector == "p" else set()
    refuse_unknown_slots(ir, continuous + everything, known)


def _derivatives(ir: Ir) -> list[Assignment]:
    rows = _rows(ir, ir.solve["continuous"]["derivative_rhs"]["scalar_plan"])
    count = ir.solve["solve_layout"]["state_scalar_count"]
    if [row.index for row in rows] != list(range(count)):
        raise ir.error(None, "not every state has a derivative")
    return rows


def _slot(target: Mapping[str, Any]) -> tuple[str, int]:
    """ "y" or "p" and the index of a target such as {"P": {"index": 3}}."""
    ((vector, where),) = target.items()
    return vector.lower(), where["index"]


def _rows(ir: Ir, plan: Mapping[str, Any]) -> list[Assignment]:
    """Each output of a plan as an assignment to "y" of its output index."""
    rows = []
    for program in plan["programs"]:
        span = program.get("span")
        try:
            outputs = read_program(program["ops"])
        except UnsupportedError as error:
            raise ir.error(span, f"{error} is not supported") from error
        rows += [Assignment("y", i, value, ir.place(span)) for i, value in outputs.items()]
    return sorted(rows, key=lambda row: row.index)


def _targeted(
    ir: Ir, plan: Mapping[str, Any], targets: Sequence[Mapping[str, Any]]
) -> list[Assignment]:
    """Each output of a plan as an assignment to the target of the same number."""
    return [Assignment(*_slot(targets[row.index]), row.value, row.place) for row in _rows(ir, plan)]


def _algebraics(ir: Ir, state_count: int) -> list[Assignment]:
    """Solve each algebraic equation for its unknown and put them in order.

    Raises BuildError for an equation that is not linear in its unknown and for loops.
    """
    continuous = ir.solve["continuous"]
    targets = continuous["implicit_row_targets"]
    solved: dict[int, Assignment] = {}
    for row in _rows(ir, continuous["implicit_rhs"]["scalar_plan"]):
        target = targets[row.index]
        if target is None:
            raise at(ir, row.place, "an equation without an unknown")
        _, unknown = _slot(target)
        try:
            value = solve_for(row.value, unknown)
        except NotAffineError:
            name = _name(ir, unknown)
            message = f"the equation for {name} is not linear in it; solve it by hand"
            raise at(ir, row.place, message) from None
        solved[unknown] = Assignment("y", unknown, value, row.place)
    missing = set(range(state_count, ir.solve["layout"]["y_scalars"])) - solved.keys()
    if missing:
        raise ir.error(None, f"no equation for {_name(ir, min(missing))}")
    return _in_order(ir, solved, state_count)


def _in_order(ir: Ir, solved: Mapping[int, Assignment], state_count: int) -> list[Assignment]:
    """Sort so that each assignment needs only states and earlier ones."""
    done: set[int] = set(range(state_count))
    order: list[Assignment] = []
    waiting = dict(solved)
    while waiting:
        ready = [i for i, a in waiting.items() if a.value.unknowns() <= done]
        if not ready:
            names = ", ".join(sorted(_name(ir, i) for i in waiting))
            first = waiting[min(waiting)]
            raise at(ir, first.place, f"algebraic loop among {names}")
        for index in ready:
            order.append(waiting.pop(index))
        done.update(ready)
    return order


def _name(ir: Ir, index: int) -> str:
    return str(ir.solve["solve_layout"]["solver_maps"]["names"][index])


def _relations(ir: Ir) -> list[Relation]:
    """The relations with their memory."""
    events = ir.solve["events"]
    memory = [_slot(target)[1] for target in events["root_relation_memory_targets"]]
    spans = [ir.place(span) for span in events["root_conditions"]["program_spans"]]
    domains: Iterable[str] = events["root_zero_domains"]
    rows = _rows(ir, events["root_plan"])
    places = spans if len(spans) == len(rows) else [row.place for row in rows]
    relations = []
    for row, slot, domain, place in zip(rows, memory, domains, places, strict=True):
        if domain not in AT_ZERO:
            raise at(ir, place, f"zero domain {domain} of a relation is not known")
        relations.append(Relation(row.value, slot, AT_ZERO[domain], place))
    return relations


def _assertions(ir: Ir) -> list[Assertion]:
    """assert() of the model; any other action stops the build."""
    events = ir.solve["events"]
    assertions = []
    for row, action in zip(_rows(ir, events["action_plan"]), events["actions"], strict=True):
        parts = action["message"]["parts"] if action["kind"] == "Assert" else []
        if not parts or any(list(part) != ["Text"] for part in parts):
            raise ir.error(action.get("span"), "only assert() with a fixed text is supported")
        text = "".join(part["Text"] for part in parts)
        assertions.append(Assertion(row.value, text, ir.place(action.get("span"))))
    return assertions


class _TimeRelations:
    """Gives comparisons of the time with something at rest a memory and a function of their own.

    The compiler leaves them as they are and lists their instants apart; as relations they are
    located like all others.
    """

    def __init__(self, ir: Ir, first_slot: int) -> None:
        self._ir, self._next = ir, first_slot
        self._slots: dict[str, int] = {}
        self.found: list[Relation] = []

    def in_row(self, row: Assignment) -> Assignment:
        """`row` with the memory in place of each such comparison."""
        return replace(row, value=self._rewritten(row.value, row.place))

    def _rewritten(self, node: Expr, place: Source | None) -> Expr:
        if node.kind in COMPARE and node.moves and not node.unknowns():
            return parameter(self._slot(node, place))
        args = tuple(self._rewritten(arg, place) for arg in node.args)
        unchanged = all(new is old for new, old in zip(args, node.args, strict=True))
        return node if unchanged else replace(node, args=args)

    def _slot(self, node: Expr, place: Source | None) -> int:
        left, right = node.args
        if node.kind in ("Eq", "Ne"):
            raise at(self._ir, place, "the time can only be compared by <, <=, >, >=")
        below = node.kind in ("Lt", "Le")
        key = str(node)
        if key not in self._slots:
            self._slots[key] = self._next
            function = Expr("Sub", (left, right) if below else (right, left))
            at_zero = "ZERO_IS_TRUE" if node.kind in ("Le", "Ge") else "ZERO_IS_FALSE"
            self.found.append(Relation(function, self._next, at_zero, place))
            self._next += 1
        return self._slots[key]


def _with_time_relations(ir: Ir, system: System) -> System:
    """The system with time events as relations."""
    times = _TimeRelations(ir, system.p_count)
    derivatives, algebraics, runtime, updates, whens = (
        [times.in_row(row) for row in rows]
        for rows in (
            system.derivatives,
            system.algebraics,
            system.runtime,
            system.updates,
            system.whens,
        )
    )
    return replace(
        system,
        p_count=system.p_count + len(times.found),
        derivatives=derivatives,
        algebraics=algebraics,
        runtime=runtime,
        updates=updates,
        whens=whens,
        relations=[*system.relations, *times.found],
    )
