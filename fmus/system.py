"""The equations of one model in the order in which they are computed.

Layout: the solve representation has a vector y (states first, then everything that follows from
them at the same instant) and a vector p (parameters, inputs, discrete variables, their previous
values, relation memory). Each relation has a function whose sign decides it; between events its
value rests in p. Slots behind the compiler's own hold what this exporter adds.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fmus.algebra import NotAffineError, solve_for
from fmus.clocks import Schedule, read_clocks
from fmus.events import AT_ZERO, Memories, Relation, Row, is_synthetic
from fmus.expressions import Expr, UnsupportedError, choice, parameter
from fmus.functions import Functions
from fmus.ir import Ir, Source
from fmus.modifiers import refuse_dropped_modifiers
from fmus.programs import read_program
from fmus.support import at, refuse_undetermined, refuse_unknown_slots, refuse_unsupported

Assignment = Row


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
    equations, all from one snapshot; `whens` of them belong to when-clauses. conditions: what the
    conditions of when-clauses were at the last event, from one snapshot. previous: (slot of pre(v),
    "y" or "p", slot of v). schedules: periodic instants, each with the slot of its flag.
    initial_flag: the slot that is true during initialization.
    """

    y_count: int
    p_count: int
    derivatives: Sequence[Assignment]
    algebraics: Sequence[Assignment]
    initial: Sequence[Assignment]
    runtime: Sequence[Assignment]
    updates: Sequence[Assignment]
    whens: Sequence[Assignment]
    conditions: Sequence[Assignment]
    previous: Sequence[tuple[int, str, int]]
    relations: Sequence[Relation]
    assertions: Sequence[Assertion]
    schedules: Sequence[tuple[int, Schedule]]
    initial_flag: int | None

    @property
    def state_count(self) -> int:
        """Number of continuous states."""
        return len(self.derivatives)


def read_system(ir: Ir) -> System:
    """Read all programs and refuse what has no meaning here.

    Raises BuildError with the place of the construct.
    """
    refuse_unsupported(ir)
    refuse_dropped_modifiers(ir)
    system = _Reader(ir).read()
    _check(ir, system)
    return system


class _Reader:
    """Reads the programs of one model."""

    def __init__(self, ir: Ir) -> None:
        self._ir = ir
        self._functions = Functions(ir)
        slots = ir.solve["layout"]["p_scalars"]
        self._clocks = read_clocks(ir, slots)
        self._p_count = slots + len(self._clocks.flags)
        self._aliases = {
            parameter(old): parameter(new) for old, new in self._clocks.aliases.items()
        }

    def read(self) -> System:
        solve = self._ir.solve
        layout, discrete, initial = (
            solve["solve_layout"],
            solve["discrete"],
            solve["initialization"],
        )
        targets = discrete["update_targets"]
        offset = discrete["rhs_plan"]["output_count"]
        equations = self._targeted(discrete["rhs_plan"], targets)
        named = {
            where["index"]
            for binding in solve["layout"]["bindings"].values()
            for vector, where in binding.items()
            if vector == "P"
        }
        previous = [
            (binding["dest_p_index"], *_slot(binding["source"]))
            for binding in layout["pre_param_bindings"]
        ]
        system = System(
            y_count=solve["layout"]["y_scalars"],
            p_count=self._p_count,
            derivatives=self._derivatives(),
            algebraics=self._algebraics(layout["state_scalar_count"]),
            initial=self._targeted(initial["update_plan"], initial["update_targets"]),
            runtime=self._targeted(
                discrete["runtime_assignment_plan"], discrete["runtime_assignment_targets"]
            ),
            updates=[row for row in equations if row.index in named],
            whens=[
                self._held(row, previous)
                for row in self._targeted(discrete["guarded_assignment_plan"], targets[offset:])
            ],
            conditions=[row for row in equations if row.index not in named],
            previous=previous,
            relations=self._relations(),
            assertions=self._assertions(),
            schedules=list(zip(self._clocks.flags, self._clocks.schedules, strict=True)),
            initial_flag=layout["initial_event_parameter_index"],
        )
        return _with_memories(self._ir, system)

    def _rows(self, plan: Mapping[str, Any]) -> list[Assignment]:
        """Each output of a plan as an assignment to "y" of its output index."""
        rows = []
        for program in plan["programs"]:
            span = program.get("span")
            try:
                outputs = read_program(program["ops"], self._functions.call)
            except UnsupportedError as error:
                raise self._ir.error(span, f"{error} is not supported") from error
            except RecursionError:
                raise self._ir.error(span, "a function is too long") from None
            place = self._ir.place(span)
            rows += [
                Assignment("y", i, value.replaced(self._aliases), place)
                for i, value in outputs.items()
            ]
        return sorted(rows, key=lambda row: row.index)

    def _targeted(
        self, plan: Mapping[str, Any], targets: Sequence[Mapping[str, Any]]
    ) -> list[Assignment]:
        """Each output of a plan as an assignment to the target of the same number."""
        return [
            Assignment(*_slot(targets[row.index]), row.value, row.place) for row in self._rows(plan)
        ]

    def _held(self, row: Assignment, previous: Sequence[tuple[int, str, int]]) -> Assignment:
        """The equation of a when-clause; it holds what its variable was before the event.

        The compiler reads the variable itself, which may already be wrong when several equations
        agree on their values at one instant; and it keeps apart which clock an equation waits for.
        """
        own = parameter(row.index)
        before = [slot for slot, vector, index in previous if (vector, index) == ("p", row.index)]
        if len(before) != 1:
            raise at(self._ir, row.place, "a discrete variable without a previous value")
        held = parameter(before[0])
        value = row.value.replaced({own: held})
        flag = self._clocks.of_slot.get(row.index)
        if flag is not None:
            value = choice(parameter(flag), value, held)
        return replace(row, value=value)

    def _derivatives(self) -> list[Assignment]:
        rows = self._rows(self._ir.solve["continuous"]["derivative_rhs"]["scalar_plan"])
        count = self._ir.solve["solve_layout"]["state_scalar_count"]
        if [row.index for row in rows] != list(range(count)):
            raise self._ir.error(None, "not every state has a derivative")
        return rows

    def _algebraics(self, state_count: int) -> list[Assignment]:
        """Solve each algebraic equation for its unknown and put them in order.

        Raises BuildError for an equation that is not linear in its unknown and for loops.
        """
        continuous = self._ir.solve["continuous"]
        targets = continuous["implicit_row_targets"]
        solved: dict[int, Assignment] = {}
        for row in self._rows(continuous["implicit_rhs"]["scalar_plan"]):
            target = targets[row.index]
            if target is None:
                raise at(self._ir, row.place, "an equation without an unknown")
            _, unknown = _slot(target)
            try:
                value = solve_for(row.value, unknown)
            except NotAffineError:
                name = _name(self._ir, unknown)
                message = f"the equation for {name} is not linear in it; solve it by hand"
                raise at(self._ir, row.place, message) from None
            solved[unknown] = Assignment("y", unknown, value, row.place)
        missing = set(range(state_count, self._ir.solve["layout"]["y_scalars"])) - solved.keys()
        if missing:
            raise self._ir.error(None, f"no equation for {_name(self._ir, min(missing))}")
        return _in_order(self._ir, solved, state_count)

    def _relations(self) -> list[Relation]:
        """The relations with their memory."""
        events = self._ir.solve["events"]
        memory = [_slot(target)[1] for target in events["root_relation_memory_targets"]]
        spans = [self._ir.place(span) for span in events["root_conditions"]["program_spans"]]
        domains: Iterable[str] = events["root_zero_domains"]
        rows = self._rows(events["root_plan"])
        places = spans if len(spans) == len(rows) else [row.place for row in rows]
        relations = []
        for row, slot, domain, place in zip(rows, memory, domains, places, strict=True):
            if domain not in AT_ZERO:
                raise at(self._ir, place, f"zero domain {domain} of a relation is not known")
            if not is_synthetic(row.value):
                relations.append(Relation(row.value, slot, AT_ZERO[domain], place))
        return relations

    def _assertions(self) -> list[Assertion]:
        """assert() of the model; any other action stops the build."""
        events = self._ir.solve["events"]
        assertions = []
        rows = self._rows(events["action_plan"])
        for row, action in zip(rows, events["actions"], strict=True):
            parts = action["message"]["parts"] if action["kind"] == "Assert" else []
            if not parts or any(list(part) != ["Text"] for part in parts):
                message = "only assert() with a fixed text is supported"
                raise self._ir.error(action.get("span"), message)
            text = "".join(part["Text"] for part in parts)
            assertions.append(Assertion(row.value, text, self._ir.place(action.get("span"))))
        return assertions


def _check(ir: Ir, system: System) -> None:
    """Refuse values that the runtime would not keep as the compiler means them."""
    rows = (*system.initial, *system.runtime, *system.updates, *system.whens, *system.conditions)
    everything = [
        (row.value, row.place) for row in (*system.derivatives, *system.algebraics, *rows)
    ]
    everything += [(relation.function, relation.place) for relation in system.relations]
    known = {row.index for row in rows if row.vector == "p"}
    refuse_undetermined(ir, known)
    known |= {slot for slot, _, _ in system.previous}
    known |= {relation.memory for relation in system.relations}
    known |= {slot for slot, _ in system.schedules}
    known |= set() if system.initial_flag is None else {system.initial_flag}
    # Memory of the compiler's own marks for whole numbers, see events.is_synthetic.
    targets = ir.solve["events"]["root_relation_memory_targets"]
    known |= {_slot(target)[1] for target in targets}
    # An edge of a clock is only seen at the instant itself: what it was before is always false.
    known |= _clock_conditions(ir)
    for binding in ir.solve["layout"]["bindings"].values():
        vector, index = _slot(binding)
        known |= {index} if vector == "p" else set()
    refuse_unknown_slots(ir, everything, known)


def _clock_conditions(ir: Ir) -> set[int]:
    """Slots for what conditions were before, of those that are a clock alone."""
    conditions = ir.dae["systems"]["conditions"]["conditions"]
    bindings = ir.solve["solve_layout"]["pre_param_bindings"]
    named = [_slot(binding) for binding in ir.solve["layout"]["bindings"].values()]
    taken = [index for vector, index in named if vector == "p"]
    first = 1 + max([b["dest_p_index"] for b in bindings] + taken, default=-1)
    return {first + c["id"] for c in conditions if c["operation"]["kind"] == "clock"}


def _slot(target: Mapping[str, Any]) -> tuple[str, int]:
    """ "y" or "p" and the index of a target such as {"P": {"index": 3}}."""
    ((vector, where),) = target.items()
    return vector.lower(), where["index"]


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


def _with_memories(ir: Ir, system: System) -> System:
    """The system with a memory for everything that jumps without being a relation yet."""
    memories = Memories(ir, system.p_count)
    system = replace(
        system,
        derivatives=memories.in_rows(system.derivatives),
        algebraics=memories.in_rows(system.algebraics),
        runtime=memories.in_rows(system.runtime),
        updates=memories.in_rows(system.updates),
        whens=memories.in_rows(system.whens, whole_parts=False),
        conditions=memories.in_rows(system.conditions),
    )
    return replace(
        system,
        p_count=system.p_count + len(memories.found),
        relations=[*system.relations, *memories.found],
    )
