"""Writes the texts of one FMU: the C source here, the model description beside."""

import hashlib
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from fmus.clocks import Schedule
from fmus.description import TOKEN_MARK, describe, identifier_of, templates
from fmus.expressions import Expr, c_number
from fmus.ir import TARGET, Ir
from fmus.system import Assignment, System, read_system
from fmus.variables import Variable, read_variables, scalars, start_vectors
from fmus.writer import Writer

RUNTIME = ("runtime.h", "solver.c", "slave.c")
SLAVES = {
    "3.0": ("fmi3.c", "fmi3_absent.c"),
    "2.0": ("fmi2.c", "fmi2_absent.c"),
}
INDENT = "    "


@dataclass(frozen=True)
class Generated:
    """Texts of one FMU.

    fmi: version of the standard. identifier: modelIdentifier, the name of the library file. token:
    instantiationToken or guid, a hash of the two texts and of the runtime.
    """

    model: str
    fmi: str
    identifier: str
    token: str
    source: str
    description: str


def runtime_files(fmi: str) -> tuple[str, ...]:
    """The files of the target folder that an FMU of version `fmi` is compiled from."""
    return (*RUNTIME, *SLAVES[fmi])


def generate(ir: Ir, step_s: float, fmi: str = "3.0") -> Generated:
    """Write the texts for a compiled model with an internal step of `step_s` seconds.

    fmi: "3.0" or "2.0". Version 2.0 knows no arrays: each element is a variable of its own.
    Raises BuildError for any construct that the runtime does not hold.
    """
    system = read_system(ir)
    variables = read_variables(ir, system)
    if fmi == "2.0":
        variables = scalars(variables)
    source = _source(ir, system, variables, step_s, fmi)
    description = describe(ir, system, variables, step_s, fmi)
    digest = hashlib.sha256()
    digest.update(source.encode())
    digest.update(description.encode())
    for name in runtime_files(fmi):
        digest.update((TARGET / name).read_bytes())
    token = digest.hexdigest()[:32]
    return Generated(
        ir.model,
        fmi,
        identifier_of(ir.model),
        token,
        source.replace(TOKEN_MARK, token),
        description.replace(TOKEN_MARK, token),
    )


def _c_string(text: str) -> str:
    """Text as a C string literal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


class _Names:
    """C names of the slots of both vectors."""

    def __init__(self, ir: Ir, state_count: int) -> None:
        self._state_count = state_count
        self.slots: list[tuple[str, int]] = []
        self._p: dict[int, str] = {}
        self._y: dict[int, str] = {}
        for name, binding in ir.solve["layout"]["bindings"].items():
            ((vector, where),) = binding.items()
            plain = re.sub(r"\W", "_", name)
            if vector == "P":
                # The index keeps a.b and a_b apart.
                text = f"P{where['index']}_{plain}"
                self.slots.append((text, where["index"]))
                self._p[where["index"]] = text
            else:
                self._y[where["index"]] = f"y{where['index']}_{plain}"
        self.slots.sort(key=lambda slot: slot[1])

    def p(self, index: int) -> str:
        """Slot of p as C text."""
        return f"p[{self._p.get(index, index)}]"

    def local(self, index: int) -> str:
        """Name of the local constant that holds an algebraic variable."""
        return self._y.get(index, f"y{index}")

    def in_derivatives(self, leaf: Expr) -> str:
        """A leaf where states come as x and algebraics are local constants."""
        if leaf.kind == "p":
            return self.p(leaf.index)
        return f"x[{leaf.index}]" if leaf.index < self._state_count else self.local(leaf.index)

    def in_vectors(self, leaf: Expr) -> str:
        """A leaf where everything rests in the vectors."""
        return self.p(leaf.index) if leaf.kind == "p" else f"y[{leaf.index}]"


def _note(assignment: Assignment) -> str:
    return f" /* {assignment.place} */" if assignment.place else ""


def _text(lines: Iterable[str]) -> str:
    return "\n".join(INDENT + line for line in lines)


def _needed(system: System, roots: Sequence[Expr]) -> list[Assignment]:
    """The algebraic equations that `roots` depend on, in order."""
    needed: set[int] = set()
    for root in roots:
        needed |= root.unknowns()
    chosen = []
    for assignment in reversed(system.algebraics):
        if assignment.index in needed:
            needed |= assignment.value.unknowns()
            chosen.append(assignment)
    return chosen[::-1]


def _from_states(
    system: System, names: _Names, roots: Sequence[Expr], store: Callable[[int, str], str]
) -> str:
    """Code that computes `roots` from the states alone; `store` writes result number and text."""
    needed = _needed(system, roots)
    writer = Writer(names.in_derivatives, [*(row.value for row in needed), *roots])
    for assignment in needed:
        value = writer.real(assignment.value)
        writer.lines.append(
            f"const double {names.local(assignment.index)} = {value};{_note(assignment)}"
        )
    for number, root in enumerate(roots):
        text = writer.real(root)
        writer.lines.append(store(number, text))
    return _text(writer.lines)


def _in_sequence(assignments: Sequence[Assignment], names: _Names) -> str:
    """Assignments in the vectors, one after the other."""
    lines: list[str] = []
    for assignment in assignments:
        writer = Writer(names.in_vectors, [assignment.value])
        target = names.in_vectors(Expr(assignment.vector, index=assignment.index))
        text = f"{target} = {writer.real(assignment.value)};{_note(assignment)}"
        inner = [f"{INDENT}{line}" for line in (*writer.lines, text)]
        lines += ["{", *inner, "}"] if writer.lines else [text]
    return _text(lines)


def _once_each(assignments: Sequence[Assignment], names: _Names) -> str:
    """Assignments in the vectors, none of which changes what an earlier one has read."""
    writer = Writer(names.in_vectors, [assignment.value for assignment in assignments])
    for assignment in assignments:
        target = names.in_vectors(Expr(assignment.vector, index=assignment.index))
        value = writer.real(assignment.value)
        writer.lines.append(f"{target} = {value};{_note(assignment)}")
    return _text(writer.lines)


def _from_snapshot(names: _Names, rows: Sequence[Assignment], count: int) -> tuple[str, str]:
    """All values first, then the stores of the first `count` rows, and those of the others."""
    writer = Writer(names.in_vectors, [row.value for row in rows])
    for number, row in enumerate(rows):
        value = writer.real(row.value)
        writer.lines.append(f"const double u{number} = {value};{_note(row)}")
    stores = [f"{names.p(row.index)} = u{number};" for number, row in enumerate(rows)]
    return _text(writer.lines + stores[:count]), _text(stores[count:])


def _assertions(system: System, names: _Names) -> str:
    lines = []
    for assertion in system.assertions:
        writer = Writer(names.in_vectors, [assertion.failed])
        failed = writer.truth(assertion.failed)
        text = f"{assertion.place}: {assertion.message}" if assertion.place else assertion.message
        test = [f"if ({failed}) {{", f"{INDENT}return {_c_string(text)};", "}"]
        inner = [f"{INDENT}{line}" for line in (*writer.lines, *test)]
        lines += ["{", *inner, "}"] if writer.lines else test
    return _text(lines)


def _source(ir: Ir, system: System, variables: Sequence[Variable], step_s: float, fmi: str) -> str:
    names = _Names(ir, system.state_count)
    start_y, start_p = start_vectors(ir, system)
    rows = [*system.updates, *system.whens]
    updates, whens = _from_snapshot(names, rows, len(system.updates))
    conditions, _ = _from_snapshot(names, system.conditions, len(system.conditions))
    previous = [
        f"{names.p(slot)} = {names.in_vectors(Expr(vector, index=index))};"
        for slot, vector, index in system.previous
    ]
    return (
        templates(c_string=_c_string)
        .get_template("model.c.jinja")
        .render(
            model=ir.model,
            states=system.state_count,
            y_count=system.y_count,
            p_count=system.p_count,
            step=c_number(step_s),
            slots=names.slots,
            start_y=[c_number(value) for value in [*start_y, 0.0]],
            start_p=[c_number(value) for value in [*start_p, 0.0]],
            y_names=ir.solve["solve_layout"]["solver_maps"]["names"],
            slave=SLAVES[fmi][0],
            variables=[_row(variable, fmi) for variable in variables],
            relations=[
                {
                    "memory": relation.memory,
                    "kind": relation.kind,
                    "place": str(relation.place or ""),
                }
                for relation in system.relations
            ],
            derivatives=_from_states(
                system,
                names,
                [row.value for row in system.derivatives],
                lambda number, text: f"dx[{number}] = {text};",
            ),
            relation_functions=_from_states(
                system,
                names,
                [relation.function for relation in system.relations],
                lambda number, text: f"z[{number}] = {text};",
            ),
            algebraics=_once_each(system.algebraics, names),
            initial=_in_sequence(system.initial, names),
            runtime=_in_sequence(system.runtime, names),
            updates=updates,
            whens=whens,
            conditions=conditions,
            previous=_text(previous),
            initial_flag=-1 if system.initial_flag is None else system.initial_flag,
            clocks=[_clock(slot, schedule) for slot, schedule in system.schedules],
            clock_times=_clock_times(system, names),
            assertions=_assertions(system, names),
        )
    )


def _clock(slot: int, schedule: Schedule) -> dict[str, object]:
    """A schedule as a row of the C table."""
    return {
        "flag": slot,
        "grid": ", ".join(c_number(float(part)) for part in schedule.grid or (0, 0, 0)),
        "place": str(schedule.place or ""),
    }


def _clock_times(system: System, names: _Names) -> str:
    """Code for start and interval of each schedule."""
    lines = []
    for number, (_, schedule) in enumerate(system.schedules):
        writer = Writer(names.in_vectors)
        lines.append(f"offset[{number}] = {writer.real(schedule.offset)};")
        lines.append(f"interval[{number}] = {writer.real(schedule.interval)};")
    return _text(lines)


def _row(variable: Variable, fmi: str) -> dict[str, str]:
    """A variable as a row of the C table."""
    class_ = "CLASS_OUTPUT"
    if variable.settable:
        class_ = "CLASS_INPUT" if variable.causality == "input" else "CLASS_PARAMETER"
    # FMI 2.0 reads an enumeration as an integer.
    kind = "Int32" if fmi == "2.0" and variable.type == "Enumeration" else variable.type
    low = -float("inf") if variable.minimum is None else variable.minimum
    high = float("inf") if variable.maximum is None else variable.maximum
    return {
        "name": variable.name,
        "type": f"TYPE_{kind.upper()}",
        "class": class_,
        "vector": f"IN_{variable.vector.upper()}",
        "index": str(variable.index),
        "count": str(variable.count),
        "min": c_number(low),
        "max": c_number(high),
    }
