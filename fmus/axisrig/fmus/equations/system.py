"""The equations of one model in the order in which they are computed.

Layout: the solve representation has a vector y (states first, then everything that follows from
them at the same instant) and a vector p (parameters, inputs, discrete variables, their previous
values, relation memory). Each relation has a function whose sign decides it; between events its
value rests in p. Slots after the compiler's own hold what this exporter adds.
"""

import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from axisrig.fmus.equations.actions import Action, actions_of, kind_of, read_message, start_check
from axisrig.fmus.equations.clocks import Schedule, read_clocks
from axisrig.fmus.equations.events import AT_ZERO, Memories, Relation, Row, is_synthetic
from axisrig.fmus.equations.exact_integers import with_exact_wholes
from axisrig.fmus.equations.sorting import Block, Equation, Solver
from axisrig.fmus.reading.expressions import (
    ONE,
    Expr,
    UnsupportedError,
    apply,
    choice,
    parameter,
    variable,
)
from axisrig.fmus.reading.functions import Functions
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.modifiers import refuse_dropped_modifiers, shared_numbers
from axisrig.fmus.reading.programs import plain_programs, read_program, start_programs
from axisrig.fmus.reading.support import (
    at,
    refuse_undetermined,
    refuse_unknown_slots,
    refuse_unsupported,
)

Assignment = Row

# Initial equations that decide an unknown; the others can only agree with what these decide.
_SOLVED = ("Solved", "SolvedThroughAlgebraicRefresh")


@dataclass(frozen=True)
class System:
    """All programs of a model.

    derivatives: of state 0..n-1, target "y" = the state. algebraics: everything else in y, in an
    order in which each needs only earlier ones. initial: parameters that follow from others, and
    initial equations. runtime: discrete variables without memory, in order. updates: discrete
    equations, all from one snapshot; `whens` of them belong to when-clauses. conditions: what the
    conditions of when-clauses were at the last event, from one snapshot. previous: (slot of pre(v),
    "y" or "p", slot of v). schedules: periodic instants, each with the slot of its flag.
    reinits: states that get a new value at an event, from one snapshot. initial_flag: the slot that
    is true during initialization. blocks: equations that hold at once. twins: (state of the
    compiler's own, the variable with whose start value it begins).
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
    actions: Sequence[Action]
    reinits: Sequence[Assignment]
    schedules: Sequence[tuple[int, Schedule]]
    initial_flag: int | None
    blocks: Sequence[Block]
    twins: Sequence[tuple[int, int]]

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
    return replace(
        system,
        runtime=with_exact_wholes(ir, system.runtime),
        updates=with_exact_wholes(ir, system.updates),
        whens=with_exact_wholes(ir, system.whens),
    )


class _Reader:
    """Reads the programs of one model."""

    def __init__(self, ir: Ir) -> None:
        self._ir = ir
        self._functions = Functions(ir)
        self._solver = Solver(ir)
        slots = ir.solve["layout"]["p_scalars"]
        self._clocks = read_clocks(ir, slots)
        self._memories = Memories(ir, slots + len(self._clocks.flags))
        self._aliases = {
            parameter(old): parameter(new) for old, new in self._clocks.aliases.items()
        }
        homotopy = ir.solve["solve_layout"]["initial_homotopy_parameter_index"]
        if homotopy is not None:
            self._aliases[parameter(homotopy)] = ONE  # homotopy() is its first argument

    def read(self) -> System:
        solve = self._ir.solve
        layout, discrete = solve["solve_layout"], solve["discrete"]
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
        at_once = self._algebraics(layout["state_scalar_count"])
        with_memory = self._memories.in_rows
        guarded = self._targeted(discrete["guarded_assignment_plan"], targets[offset:])
        whens = [self._held(row, previous) for row in guarded if row.vector == "p"]
        reinits = [self._gated(row) for row in guarded if row.vector == "y"]
        runtime = discrete["runtime_assignment_plan"], discrete["runtime_assignment_targets"]
        system = System(
            y_count=solve["layout"]["y_scalars"],
            p_count=0,
            derivatives=with_memory(self._derivatives()),
            algebraics=self._solved(at_once),
            initial=self._initial(at_once),
            runtime=with_memory(self._targeted(*runtime)),
            updates=with_memory([row for row in equations if row.index in named]),
            whens=with_memory(whens, whole_parts=False),
            conditions=with_memory([row for row in equations if row.index not in named]),
            previous=previous,
            relations=self._relations(),
            actions=self._actions(),
            reinits=with_memory(reinits, whole_parts=False),
            schedules=list(zip(self._clocks.flags, self._clocks.schedules, strict=True)),
            initial_flag=layout["initial_event_parameter_index"],
            blocks=self._solver.blocks,
            twins=self._twins(at_once, layout["state_scalar_count"]),
        )
        return replace(
            system,
            p_count=self._memories.end,
            relations=[*system.relations, *self._memories.found],
        )

    def _rows(self, plan: Mapping[str, Any]) -> list[Assignment]:
        """Each output of a plan as an assignment to "y" of its output index."""
        rows = []
        for program in plan["programs"]:
            span = program.get("span")
            linear = functools.partial(self._solver.linear, self._ir.place(span))
            try:
                outputs = read_program(program["ops"], self._functions.call, linear)
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

    def _gated(self, row: Assignment) -> Assignment:
        """reinit() of a state, which may wait for a clock."""
        if row.index >= self._ir.solve["solve_layout"]["state_scalar_count"]:
            raise at(self._ir, row.place, "reinit() of a variable that is not a state")
        return row

    def _derivatives(self) -> list[Assignment]:
        rows = self._rows(self._ir.solve["continuous"]["derivative_rhs"]["scalar_plan"])
        count = self._ir.solve["solve_layout"]["state_scalar_count"]
        if [row.index for row in rows] != list(range(count)):
            raise self._ir.error(None, "not every state has a derivative")
        return rows

    def _algebraics(self, state_count: int) -> list[Equation]:
        """What holds between the states and everything else in y at any time."""
        continuous = self._ir.solve["continuous"]
        targets = continuous["implicit_row_targets"]
        equations = []
        rows = self._memories.in_rows(self._rows(continuous["implicit_rhs"]["scalar_plan"]))
        for row in rows:
            target = targets[row.index]
            if target is None:
                raise at(self._ir, row.place, "an equation without an unknown")
            equations.append(Equation(row.value, variable(_slot(target)[1]), row.place))
        found = {equation.unknown.index for equation in equations}
        missing = set(range(state_count, self._ir.solve["layout"]["y_scalars"])) - found
        if missing:
            raise self._ir.error(None, f"no equation for {_name(self._ir, min(missing))}")
        return equations

    def _twins(self, equations: Sequence[Equation], count: int) -> list[tuple[int, int]]:
        """States that replace a variable of the model, as after index reduction."""
        declared = {name for v in self._ir.dae["variables"] for name in v["scalar_names"]}
        equal: dict[int, int] = {}
        for equation in equations:
            parts = equation.residual.args
            if equation.residual.kind == "Sub" and all(part.kind == "y" for part in parts):
                equal[parts[0].index] = parts[1].index
                equal[parts[1].index] = parts[0].index
        twins = []
        for state in range(count):
            if _name(self._ir, state) not in declared:
                if state not in equal:
                    message = f"the start of {_name(self._ir, state)} is not known"
                    raise self._ir.error(None, message)
                twins.append((state, equal[state]))
        return twins

    def _solved(self, equations: Sequence[Equation]) -> list[Assignment]:
        return [
            Assignment(
                solution.unknown.kind, solution.unknown.index, solution.value, solution.place
            )
            for solution in self._solver.solve(equations)
        ]

    def _initial(self, equations_at_once: Sequence[Equation]) -> list[Assignment]:
        """What holds at the start only, with all that it needs of what holds at any time."""
        initial = self._ir.solve["initialization"]
        equations = [
            Equation(apply("Sub", leaf, row.value), leaf, row.place)
            for row in self._targeted(initial["update_plan"], initial["update_targets"])
            for leaf in [Expr(row.vector, index=row.index)]
        ]
        equations += [
            Equation(apply("Sub", parameter(slot), parameter(other)), parameter(slot), place)
            for slot, other, place in shared_numbers(self._ir)
        ]
        residuals = self._initial_residuals()
        for block in initial["projection_plan"]["blocks"]:
            for row, target in zip(block["rows"], block["unknowns"], strict=True):
                vector, index = _slot(target)
                residual = residuals[row]
                equations.append(
                    Equation(residual.value, Expr(vector, index=index), residual.place)
                )
        return self._solved(_with_needed(equations, equations_at_once))

    def _initial_residuals(self) -> dict[int, Assignment]:
        rows = self._rows({"programs": start_programs(self._ir)})
        return {row.index: row for row in rows}

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

    def _actions(self) -> list[Action]:
        """assert() and terminate() of the model."""
        actions = []
        plan = self._rows(self._ir.solve["events"]["action_plan"])
        rows = self._memories.in_rows(plan, comparisons=True)
        for row, action in zip(rows, actions_of(self._ir), strict=True):
            span = action.get("span")
            try:
                text, values = read_message(action, self._value)
            except UnsupportedError as error:
                raise self._ir.error(span, f"{error} is not supported") from error
            condition = row.value
            if action["clock_owner"] is not None:
                flag = self._clocks.of_clock.get(action["clock_owner"])
                if flag is None:
                    raise self._ir.error(span, "an assertion that waits for several clocks")
                condition = apply("And", parameter(flag), condition)
            kind = kind_of(action)
            memory = self._memories.slot() if kind == "warning" else -1
            place = self._ir.place(span)
            actions.append(Action(kind, condition, text, values, place, memory=memory))
        return actions + self._start_checks()

    def _value(self, raw: Sequence[Mapping[str, Any]]) -> Expr:
        """The value of one program in the compiler's own form."""
        node = {"ScalarPrograms": {"output_indices": [0], "programs": [raw]}}
        (program,) = plain_programs({"nodes": [node]})
        return self._rows({"programs": [program]})[0].value

    def _start_checks(self) -> list[Action]:
        """Start values that are given although equations decide them."""
        roles = self._ir.solve["initialization"]["row_roles"]
        surplus = [number for number, role in enumerate(roles) if role not in _SOLVED]
        residuals = self._initial_residuals() if surplus else {}
        return [start_check(residuals[n].value, residuals[n].place) for n in surplus]


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


def _with_needed(equations: Sequence[Equation], others: Sequence[Equation]) -> list[Equation]:
    """The equations, and those of the others that they depend on."""
    by_unknown = {equation.unknown: equation for equation in others}
    chosen = {equation.unknown: equation for equation in equations}
    waiting = list(equations)
    while waiting:
        for leaf in waiting.pop().residual.leaves():
            if leaf in by_unknown and leaf not in chosen:
                chosen[leaf] = by_unknown[leaf]
                waiting.append(chosen[leaf])
    return list(chosen.values())


def _name(ir: Ir, index: int) -> str:
    return str(ir.solve["solve_layout"]["solver_maps"]["names"][index])
