"""The equations of one model in the order in which they are computed.

Layout: the solve representation has a vector y (states first, then everything that follows from
them at the same instant) and a vector p (parameters, inputs, discrete variables, their previous
values, relation memory). Each relation has a function whose sign decides it; between events its
value rests in p.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fmus.expressions import Expr, NotAffineError, UnsupportedError, read_program, solve_for
from fmus.ir import Ir, Source

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
    _refuse_unsupported(ir)
    solve = ir.solve
    layout = solve["solve_layout"]
    discrete = solve["discrete"]
    count = layout["state_scalar_count"]
    by_output = {
        a.index: a for a in _rows(ir, solve["continuous"]["derivative_rhs"]["scalar_plan"])
    }
    if sorted(by_output) != list(range(count)):
        raise ir.error(None, "not every state has a derivative")
    updates = _targeted(ir, discrete["rhs_plan"], discrete["update_targets"])
    offset = discrete["rhs_plan"]["output_count"]
    whens = _targeted(ir, discrete["guarded_assignment_plan"], discrete["update_targets"][offset:])
    if len(updates) + len(whens) != len(discrete["update_targets"]):
        raise ir.error(None, "discrete equations and their targets do not match")
    initial = solve["initialization"]
    return System(
        y_count=solve["layout"]["y_scalars"],
        p_count=solve["layout"]["p_scalars"],
        derivatives=[by_output[index] for index in range(count)],
        algebraics=_algebraics(ir, count),
        initial=_targeted(ir, initial["update_plan"], initial["update_targets"]),
        runtime=_targeted(
            ir, discrete["runtime_assignment_plan"], discrete["runtime_assignment_targets"]
        ),
        updates=updates,
        whens=whens,
        previous=[
            (binding["dest_p_index"], *_slot(binding["source"]))
            for binding in layout["pre_param_bindings"]
        ],
        relations=_relations(ir),
        assertions=_assertions(ir),
    )


def _refuse_unsupported(ir: Ir) -> None:
    """Stop at everything in the representation that the runtime does not act on."""
    solve = ir.solve
    layout, events, clocks = solve["solve_layout"], solve["events"], solve["clocks"]
    initial, discrete = solve["initialization"], solve["discrete"]
    implicit = solve["continuous"]["implicit_rhs"]["scalar_plan"]
    clocked = [b for b in layout["pre_param_bindings"] if b["clock_schedule"] is not None]
    mass = solve["artifacts"]["continuous"]["mass_matrix"]["kind"]
    refused: Sequence[tuple[object, str | None, str]] = (
        (clocks["activation_parameter_indices"], "sample", "sample() and clocks are"),
        (clocks["periodic_event_schedules"], "sample", "sample() and clocks are"),
        (clocked, None, "clocked variables are"),
        (layout["initial_event_parameter_index"] is not None, "initial", "initial() is"),
        (layout["terminal_event_parameter_index"] is not None, "terminal", "terminal() is"),
        (layout["initial_homotopy_parameter_index"] is not None, "homotopy", "homotopy() is"),
        (initial["residual"]["nodes"], None, "an initial equation without explicit unknown is"),
        (initial["projection_plan"]["blocks"], None, "a system of initial equations is"),
        (events["scheduled_root_conditions"], None, "a scheduled root condition is"),
        (events["scheduled_time_events"], None, "a scheduled time event is"),
        (events["dynamic_time_event_names"], None, "a dynamic time event is"),
        (mass != "identity", None, "a mass matrix is"),
        (any(discrete["observation_refresh"]), None, "an observed discrete variable is"),
        (implicit["uses_linear_solve_component"], None, "a linear system of equations is"),
    )
    for found, word, message in refused:
        if found:
            raise ir.error(_find(ir, word), f"{message} not supported")
    spans = [program.get("span") for program in _programs(discrete)]
    for target, span in zip(discrete["update_targets"], spans, strict=True):
        if "P" not in target:
            raise ir.error(span, "reinit() is not supported")


def _programs(discrete: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The program of each update target, in the order of the targets."""
    return [
        program
        for plan in ("rhs_plan", "guarded_assignment_plan")
        for program in discrete[plan]["programs"]
        for _ in range(program["output_count"])
    ]


def _find(ir: Ir, word: str | None) -> Mapping[str, int] | None:
    """The span of the first use of a built-in function in the model's files."""
    if word is None:
        return None
    for number, (_, text) in ir.files.items():
        found = re.search(rf"\b{word}\s*\(", text)
        if found:
            return {"source": number, "start": len(text[: found.start()].encode())}
    return None


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
            raise _at(ir, row.place, "an equation without an unknown")
        _, unknown = _slot(target)
        try:
            value = solve_for(row.value, unknown)
        except NotAffineError:
            name = _name(ir, unknown)
            message = f"the equation for {name} is not linear in it; solve it by hand"
            raise _at(ir, row.place, message) from None
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
            raise _at(ir, first.place, f"algebraic loop among {names}")
        for index in ready:
            order.append(waiting.pop(index))
        done.update(ready)
    return order


def _name(ir: Ir, index: int) -> str:
    return str(ir.solve["solve_layout"]["solver_maps"]["names"][index])


def _at(ir: Ir, place: Source | None, message: str) -> Exception:
    error = ir.error(None, message)
    return error if place is None else type(error)(place.file, place.line, message)


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
            raise _at(ir, place, f"zero domain {domain} of a relation is not known")
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
