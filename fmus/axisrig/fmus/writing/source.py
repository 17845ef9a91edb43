"""Writes the C source of one model."""

import re
from collections.abc import Callable, Collection, Iterable, Sequence

from axisrig.fmus.equations.actions import Action
from axisrig.fmus.equations.sorting import Block
from axisrig.fmus.equations.system import Assignment, System
from axisrig.fmus.reading.expressions import Expr, c_number
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.branches import Lazy, lazy_rows
from axisrig.fmus.writing.description import OWN_LIBRARY, templates
from axisrig.fmus.writing.early import early_levels
from axisrig.fmus.writing.variables import Variable, start_vectors
from axisrig.fmus.writing.writer import Writer

INDENT = "    "


def write_source(
    ir: Ir,
    system: System,
    variables: Sequence[Variable],
    folded: Collection[int],
    step_s: float,
    slave: str,
) -> str:
    """The C source of a model; `slave` is the file of the runtime that it includes.

    folded: slots of p whose start values the equations hold. step_s: internal step of the
    integration, s.
    """
    start_y, start_p = start_vectors(ir, system)
    for state, twin in system.twins:
        start_y[state] = start_y[twin]
    source = _Source(ir, system)
    return (
        templates(c_string=_c_string)
        .get_template("model.c.jinja")
        .render(
            model=ir.model,
            is_own=ir.model.partition(".")[0] == OWN_LIBRARY,
            slave=slave,
            system=system,
            code=source,
            step=c_number(step_s),
            start_y=[c_number(value) for value in [*start_y, 0.0]],
            start_p=[c_number(value) for value in [*start_p, 0.0]],
            y_names=ir.solve["solve_layout"]["solver_maps"]["names"],
            variables=[_row(variable, slave) for variable in variables],
            folded=sorted(folded),
            early=early_levels(ir, variables),
        )
    )


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


class _Source:
    """The parts of the C source; each is the body of one function or the rows of a table."""

    def __init__(self, ir: Ir, system: System) -> None:
        self._system = system
        self._names = _Names(ir, system.state_count)
        # Newton's method begins at the last solution, which rests in the vectors.
        self._guesses = {
            block.number: [self._names.in_vectors(unknown) for unknown in block.unknowns]
            for block in system.blocks
        }
        self.slots = self._names.slots
        self.largest_block = max((len(block.unknowns) for block in system.blocks), default=0)

    def _writer(self, roots: Sequence[Expr]) -> Writer:
        return Writer(self._names.in_vectors, roots, self._guesses)

    # --- functions of the states

    def derivatives(self) -> str:
        """State derivatives from the states alone."""
        roots = [row.value for row in self._system.derivatives]
        return self._from_states(roots, lambda number, text: f"dx[{number}] = {text};")

    def relation_functions(self) -> str:
        """Functions of the relations from the states alone."""
        roots = [relation.function for relation in self._system.relations]
        return self._from_states(roots, lambda number, text: f"z[{number}] = {text};")

    def _from_states(self, roots: Sequence[Expr], store: Callable[[int, str], str]) -> str:
        """Code that computes `roots` and what they need; `store` writes number and text."""
        needed = self._needed(roots)
        everything = [*(row.value for row in needed), *roots]
        writer = Writer(self._names.in_derivatives, everything, self._guesses)
        self._write_rows(writer, lazy_rows(needed, roots))
        for number, root in enumerate(roots):
            text = writer.real(root)
            writer.lines.append(store(number, text))
        return _text(writer.lines)

    def _write_rows(self, writer: Writer, rows: Sequence[Assignment | Lazy]) -> None:
        """Write local constants; what only one branch of a choice needs is written inside it."""
        for row in rows:
            if isinstance(row, Assignment):
                value, name = writer.real(row.value), self._names.local(row.index)
                writer.lines.append(f"const double {name} = {value};{_note(row)}")
                continue
            name = self._names.local(row.choice.index)
            condition, *values = row.choice.value.args
            text = writer.truth(condition)
            writer.lines.append(f"double {name};{_note(row.choice)}")
            heads = (f"if ({text}) {{", "else {")
            for head, inside, value_of in zip(heads, row.branches, values, strict=True):
                inner = writer.branch()
                self._write_rows(inner, inside)
                value = inner.real(value_of)
                inner.lines.append(f"{name} = {value};")
                writer.add_block(head, inner)

    def _needed(self, roots: Sequence[Expr]) -> list[Assignment]:
        """The algebraic equations that `roots` depend on, in order."""
        needed: set[int] = set()
        for root in roots:
            needed |= root.unknowns()
        chosen = []
        for assignment in reversed(self._system.algebraics):
            if assignment.index in needed:
                needed |= assignment.value.unknowns()
                chosen.append(assignment)
        return chosen[::-1]

    # --- assignments in the vectors

    def algebraics(self) -> str:
        """What follows from the states at the same instant."""
        return self._once_each(self._system.algebraics)

    def initial(self) -> str:
        """Parameters that follow from others, and initial equations."""
        return self._once_each(self._system.initial)

    def _once_each(self, rows: Sequence[Assignment]) -> str:
        """Assignments none of which changes what an earlier one has read."""
        writer = self._writer([row.value for row in rows])
        for row in rows:
            value = writer.real(row.value)
            writer.lines.append(f"{self._target(row)} = {value};{_note(row)}")
        return _text(writer.lines)

    def runtime(self) -> str:
        """Discrete variables without memory, one after the other."""
        lines: list[str] = []
        for row in self._system.runtime:
            writer = self._writer([row.value])
            text = f"{self._target(row)} = {writer.real(row.value)};{_note(row)}"
            lines += _scoped([*writer.lines, text])
        return _text(lines)

    def updates(self) -> str:
        """Discrete equations: all values first, then the stores, those of when-clauses last."""
        system = self._system
        rows = [*system.updates, *system.whens]
        lines, stores = self._from_snapshot(rows)
        count = len(system.updates)
        rest = ["if (!with_whens) {", f"{INDENT}return 0;", "}"] if system.whens else []
        return _text([*lines, *stores[:count], *rest, *stores[count:]])

    def conditions(self) -> str:
        """What the conditions of when-clauses are."""
        lines, stores = self._from_snapshot(self._system.conditions)
        return _text([*lines, *stores])

    def _from_snapshot(self, rows: Sequence[Assignment]) -> tuple[list[str], list[str]]:
        """Lines that compute all values, and those that store them."""
        writer = self._writer([row.value for row in rows])
        for number, row in enumerate(rows):
            value = writer.real(row.value)
            writer.lines.append(f"const double u{number} = {value};{_note(row)}")
        return writer.lines, [f"{self._target(row)} = u{n};" for n, row in enumerate(rows)]

    def previous(self) -> str:
        """pre(v) := v"""
        return _text(
            f"{self._names.p(slot)} = {self._names.in_vectors(Expr(vector, index=index))};"
            for slot, vector, index in self._system.previous
        )

    def _target(self, row: Assignment) -> str:
        return self._names.in_vectors(Expr(row.vector, index=row.index))

    # --- tables and the rest

    def entry(self) -> str:
        """pre(v) of continuous variables."""
        pairs = [(slot, index) for slot, vector, index in self._system.previous if vector == "y"]
        if not pairs:
            return ""
        lines = ["const int bad = model_algebraics(t, y, p);", "if (bad) {", "    return bad;", "}"]
        return _text([*lines, *(f"{self._names.p(slot)} = y[{index}];" for slot, index in pairs)])

    def reinit(self) -> str:
        """States that get a new value at an event."""
        lines, stores = self._from_snapshot(self._system.reinits)
        return _text([*lines, *stores])

    def actions(self) -> str:
        """assert() and terminate()."""
        lines: list[str] = []
        for action in self._system.actions:
            values = [value for _, value in action.values]
            writer = self._writer([action.condition, *values])
            condition = writer.truth(action.condition)
            texts = [_printed(kind, writer.real(value)) for kind, value in action.values]
            place = f"{action.place}: " if action.place else ""
            text = _c_string(f"{place.replace('%', '%%')}{action.text} (t = %.12g s)")
            arguments = ", ".join([text, *texts, "t"])
            lines += _scoped([*writer.lines, *_action(action, condition, arguments)])
        return _text(lines)

    def clock_times(self) -> str:
        """Start and interval of each schedule."""
        lines = []
        for number, (_, schedule) in enumerate(self._system.schedules):
            writer = self._writer([])
            lines.append(f"offset[{number}] = {writer.real(schedule.offset)};")
            lines.append(f"interval[{number}] = {writer.real(schedule.interval)};")
        return _text(lines)

    def clocks(self) -> list[dict[str, object]]:
        """The schedules as rows of the C table."""
        return [
            {
                "flag": slot,
                "grid": ", ".join(c_number(float(part)) for part in schedule.grid or (0, 0, 0)),
                "place": str(schedule.place or ""),
            }
            for slot, schedule in self._system.schedules
        ]

    def block_functions(self) -> list[dict[str, object]]:
        """The blocks that Newton's method solves: number, body of the function."""
        return [
            {"number": block.number, "body": self._block(block), "note": ", ".join(block.names)}
            for block in self._system.blocks
            if block.unknowns
        ]

    def _block(self, block: Block) -> str:
        places = {leaf: f"input[{k}]" for k, leaf in enumerate(block.inputs)}
        places |= {leaf: f"u[{k}]" for k, leaf in enumerate(block.unknowns)}
        writer = Writer(lambda leaf: places[leaf], [*block.residuals, *block.slopes])
        for name, rows in (("residual", block.residuals), ("slope", block.slopes)):
            for number, row in enumerate(rows):
                text = writer.real(row)
                writer.lines.append(f"{name}[{number}] = {text};")
        return _text(writer.lines)

    def block_names(self) -> list[dict[str, str]]:
        """The blocks as rows of the C table."""
        return [
            {"names": ", ".join(block.names), "place": str(block.place or "")}
            for block in self._system.blocks
        ]


def _printed(kind: str, value: str) -> str:
    """A value as an argument of printf."""
    return f'{value} != 0.0 ? "true" : "false"' if kind == "Boolean" else value


def _action(action: Action, condition: str, arguments: str) -> list[str]:
    """What happens when the condition of an action holds."""
    if action.kind == "warning":
        said = f"p[{action.memory}]"
        return [
            f"const double says = {condition} ? 1.0 : 0.0;",
            f"if (says > {said} && notes->warnings++ < N_WARNINGS) {{",
            f"{INDENT}snprintf(notes->warning[notes->warnings - 1], WARNING_SIZE, {arguments});",
            "}",
            f"{said} = says;",
        ]
    result = "SOLVER_TERMINATED" if action.kind == "terminate" else "SOLVER_FAILED"
    start = "at_start && " if action.at_start else ""
    return [
        f"if ({start}{condition}) {{",
        f"{INDENT}snprintf(notes->text, sizeof notes->text, {arguments});",
        f"{INDENT}return {result};",
        "}",
    ]


def _scoped(lines: Sequence[str]) -> list[str]:
    """Lines in braces where they hold constants of their own."""
    if not any(line.startswith(("const ", "double ")) for line in lines):
        return list(lines)
    return ["{", *(f"{INDENT}{line}" for line in lines), "}"]


def _note(assignment: Assignment) -> str:
    return f" /* {assignment.place} */" if assignment.place else ""


def _text(lines: Iterable[str]) -> str:
    return "\n".join(INDENT + line for line in lines)


def _c_string(text: str) -> str:
    """Text as a C string literal."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _row(variable: Variable, slave: str) -> dict[str, str]:
    """A variable as a row of the C table."""
    class_ = "CLASS_OUTPUT"
    if variable.settable:
        class_ = "CLASS_INPUT" if variable.causality == "input" else "CLASS_PARAMETER"
    # FMI 2.0 reads an enumeration as an integer.
    kind = "Int32" if slave == "fmi2.inc" and variable.type == "Enumeration" else variable.type
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
