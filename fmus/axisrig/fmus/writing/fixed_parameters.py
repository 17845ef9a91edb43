"""Parameters whose value the compiler has used: a new value would not reach all equations.

Source: behaviour of rumoca 0.10.2. A parameter that decides which equations a model has is replaced
by its number everywhere. In the equations of when-clauses an if-expression is decided where the
numbers of its parameters decide the condition, while other equations still read the parameter.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from axisrig.fmus.equations.system import System
from axisrig.fmus.reading.expressions import Expr
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.variables import Variable

NOTE = "(no effect in this FMU: the compiler has used its value)"


def folded_slots(ir: Ir, system: System) -> frozenset[int]:
    """The slots of p whose start values the equations hold in place of a reading.

    Parameters that nothing reads, those decided in a when-clause, and all from which a calculated
    parameter of that kind follows. One that only calculated parameters read which no equation
    mentions is not among them: it has the effect that the model says.
    """
    parameters = _slots_of_parameters(ir)
    follows = {
        row.index: _read([row.value])
        for row in system.initial
        if row.vector == "p" and row.index in parameters
    }
    others = [row.value for row in system.initial if row.vector == "y" or row.index not in follows]
    read = _read([*_programs(system), *others])
    read |= {slot for _, vector, slot in system.previous if vector == "p"}
    mentioned = set(_mentioned(ir))
    lost = {
        slot for slot, name in parameters.items() if slot in follows and slot not in read
        and name in mentioned and not _is_source(slot, follows)
    }  # fmt: skip
    lost |= _decided(ir, system, parameters)
    waiting = list(lost)
    while waiting:
        for source in follows.get(waiting.pop(), set()) - lost:
            lost.add(source)
            waiting.append(source)
    reached = read.union(*follows.values())
    return frozenset(s for s in parameters if s in lost or s not in reached | set(follows))


def with_notes(variables: Iterable[Variable], folded: Collection[int]) -> list[Variable]:
    """The variables; the description of each that cannot be changed says so."""
    return [
        replace(variable, description=f"{variable.description} {NOTE}".strip())
        if variable.settable
        and any(vector == "p" and index in folded for vector, index in variable.slots)
        else variable
        for variable in variables
    ]


def _is_source(slot: int, follows: Mapping[int, set[int]]) -> bool:
    return any(slot in sources for sources in follows.values())


def _slots_of_parameters(ir: Ir) -> dict[int, str]:
    """Slot and name of each element of each parameter."""
    bindings = ir.solve["layout"]["bindings"]
    return {
        bindings[element]["P"]["index"]: str(variable["name"])
        for variable in ir.dae["variables"]
        if variable["role"] == "parameter"
        for element in variable["scalar_names"]
        if "P" in bindings.get(element, {})
    }


def _programs(system: System) -> Iterator[Expr]:
    """Everything that the FMU computes, but what parameters follow from."""
    rows = (
        *system.derivatives,
        *system.algebraics,
        *system.runtime,
        *system.updates,
        *system.whens,
        *system.conditions,
        *system.reinits,
    )
    yield from (row.value for row in rows)
    yield from (relation.function for relation in system.relations)
    for action in system.actions:
        yield action.condition
        yield from (value for _, value in action.values)
    for _, schedule in system.schedules:
        yield from (schedule.offset, schedule.interval)
    for block in system.blocks:
        yield from (*block.residuals, *block.inputs)


def _read(values: Iterable[Expr]) -> set[int]:
    return {leaf.index for value in values for leaf in value.leaves() if leaf.kind == "p"}


# --- the flattened model -------------------------------------------------------------------------


def _nodes(node: Any) -> Iterator[Mapping[str, Any]]:
    """Every mapping of the flattened model below a node."""
    stack = [node]
    while stack:
        found = stack.pop()
        if isinstance(found, Mapping):
            yield found
            stack.extend(found.values())
        elif isinstance(found, Sequence) and not isinstance(found, str):
            stack.extend(found)


def _references(node: Any) -> set[str]:
    """The names that a part of the flattened model reads."""
    return {str(found["VarRef"]["name"]["name"]) for found in _nodes(node) if "VarRef" in found}


def _mentioned(ir: Ir) -> set[str]:
    """Names in equations, algorithms and what decides the structure of the model."""
    flat = ir.flat
    parts = [part for name, part in flat.items() if "equations" in name or "algorithms" in name]
    found = _references([*parts, flat["when_chains"]])
    for selection in flat.get("parameter_branch_selections") or ():
        found |= {".".join(reference) for reference in selection["references"]}
    return found


def _decided(ir: Ir, system: System, parameters: Mapping[int, str]) -> set[int]:
    """Parameters of conditions inside when-clauses that the program of the clause does not read.

    Where several conditions of one equation name a parameter, one of them may be decided while
    another is not: such a parameter counts as decided.
    """
    slots: dict[str, set[int]] = {}
    for slot, name in parameters.items():
        slots.setdefault(name, set()).add(slot)
    programs: dict[tuple[str, int], set[int]] = {}
    for row in (*system.whens, *system.reinits):
        programs.setdefault((row.vector, row.index), set()).update(_read([row.value]))
    found: set[int] = set()
    for target, value in _assigned(ir.flat["when_chains"]):
        known = _program_of(ir, target, programs)
        conditions = [
            _references(branch[0])
            for node in _nodes(value)
            if "If" in node
            for branch in node["If"]["branches"]
        ]
        for name in set().union(*conditions) & set(slots):
            several = sum(name in condition for condition in conditions) > 1
            if several or not slots[name] & known:
                found |= slots[name]
    return found


def _assigned(chains: Any) -> Iterator[tuple[str, Any]]:
    """Target and value of each equation in when-clauses."""
    for node in _nodes(chains):
        if "target" in node and "value" in node:
            yield str(node["target"]), node["value"]
        elif "state" in node and "value" in node:
            yield str(node["state"]), node["value"]


def _program_of(ir: Ir, target: str, programs: Mapping[tuple[str, int], set[int]]) -> set[int]:
    """The slots of p that the programs of a variable read."""
    found: set[int] = set()
    for name, binding in ir.solve["layout"]["bindings"].items():
        if name == target or name.startswith(f"{target}["):
            ((vector, where),) = binding.items()
            found |= programs.get((vector.lower(), where["index"]), set())
    return found
