"""Periodic instants: when sample(start, interval) is true, and which equations wait for it."""

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from axisrig.fmus.reading.expressions import Expr, apply, const, parameter
from axisrig.fmus.reading.ir import Ir, Source

# A grid of whole numbers up to this one is exact in a double.
_EXACT = 2**53
_OPERATORS = {ast.Add: "Add", ast.Sub: "Sub", ast.Mult: "Mul", ast.Div: "Div"}


@dataclass(frozen=True)
class Schedule:
    """The instants offset + k*interval, k = 0, 1, ...

    grid: (a, b, d) when the instants are the numbers (a + k*b)/d, else None and the two
    expressions count; they read parameters only.
    """

    offset: Expr
    interval: Expr
    grid: tuple[int, int, int] | None
    place: Source | None = field(compare=False)


@dataclass(frozen=True)
class Clocks:
    """All schedules. flags: for each the slot of p that is true at its instants.

    of_slot: the flag that a discrete variable waits for, by its slot in p. aliases: the compiler's
    own flag to ours. of_clock: our flag of a clock of the compiler that is one schedule.
    """

    schedules: Sequence[Schedule]
    flags: Sequence[int]
    of_slot: Mapping[int, int]
    aliases: Mapping[int, int]
    of_clock: Mapping[int, int]


def read_clocks(ir: Ir, first_slot: int) -> Clocks:
    """The schedules of a model; their flags are new slots of p from `first_slot` on.

    Raises BuildError for an instant that the runtime could not follow.
    """
    return _Reader(ir, first_slot).read()


class _Reader:
    def __init__(self, ir: Ir, first_slot: int) -> None:
        self._ir = ir
        self._first = first_slot
        self._systems = ir.dae["systems"]
        self._conditions = self._systems["conditions"]["conditions"]
        self._schedules: list[Schedule] = []
        self._of_clock: dict[int, set[int]] = {}

    def read(self) -> Clocks:
        of_variable = {
            ownership["variable"]: self._schedule_of(ownership)
            for ownership in self._systems["clocks"]["ownerships"]
        }
        for condition in self._conditions:
            if condition["operation"]["kind"] == "clock":
                clock = condition["operation"]["clock"]
                if clock not in self._of_clock:  # read by its flag alone
                    self._remember(clock, self._schedule(condition, ""))
        flags = [self._first + k for k in range(len(self._schedules))]
        of_slot = {}
        bindings = self._ir.solve["layout"]["bindings"]
        for variable, number in of_variable.items():
            for name in self._ir.dae["variables"][variable]["scalar_names"]:
                ((vector, where),) = bindings[name].items()
                if vector == "P":
                    of_slot[where["index"]] = flags[number]
        of_clock = {
            clock: flags[next(iter(numbers))]
            for clock, numbers in self._of_clock.items()
            if len(numbers) == 1
        }
        slots = self._ir.solve["clocks"]["activation_parameter_indices"]
        aliases = {slots[clock]: flag for clock, flag in of_clock.items()}
        return Clocks(self._schedules, flags, of_slot, aliases, of_clock)

    def _schedule_of(self, ownership: Mapping[str, Any]) -> int:
        """The schedule that a discrete variable waits for."""
        variable = self._ir.dae["variables"][ownership["variable"]]
        span = variable["declaration"].get("span")
        if ownership["sampled"]:
            raise self._ir.error(span, f"{variable['name']} on a clock: only sample() is supported")
        found = {
            self._schedule(condition, variable["name"])
            for condition in self._conditions_of(ownership["variable"])
        }
        if len(found) != 1:
            message = f"{variable['name']} needs exactly one sample() that decides when it changes"
            raise self._ir.error(span, message)
        return self._remember(ownership["clock"], found.pop())

    def _remember(self, clock: int, schedule: Schedule) -> int:
        if schedule not in self._schedules:
            self._schedules.append(schedule)
        number = self._schedules.index(schedule)
        self._of_clock.setdefault(clock, set()).add(number)
        return number

    def _conditions_of(self, variable: int) -> list[Mapping[str, Any]]:
        """The sample() conditions that the equations of a discrete variable wait for."""
        triggers = [
            branch["activation"]["trigger"]
            for owner in self._systems["discrete_values"]["owners"]
            if variable in owner["targets"]
            for branch in owner["branches"]
            if branch["activation"]["kind"] == "when"
        ]
        for owner in self._systems["discrete_real"]["residuals"]:
            residual = self._ir.dae["expressions"][owner["residual"]]
            if owner["activation"]["kind"] == "when" and variable in self._written(residual):
                triggers.append(owner["activation"]["trigger"])
        return [leaf for trigger in triggers for leaf in self._clock_leaves(trigger)]

    def _written(self, residual: Mapping[str, Any]) -> set[int]:
        """The variable on the left side of a discrete equation, as an element or whole."""
        operation = residual["operation"]
        while operation["kind"] != "coordinate":
            key = next((k for k in ("lhs", "base", "operand") if k in operation), None)
            if key is None:
                return set()
            operation = self._ir.dae["expressions"][operation[key]]["operation"]
        return {operation["coordinate"].get("id", -1)}

    def _clock_leaves(self, number: int) -> Iterator[Mapping[str, Any]]:
        condition = self._conditions[number]
        operation = condition["operation"]
        if operation["kind"] == "clock":
            yield condition
        for key in ("lhs", "rhs", "condition"):
            if key in operation:
                yield from self._clock_leaves(operation[key])

    # --- one sample()

    def _schedule(self, condition: Mapping[str, Any], owner: str) -> Schedule:
        """The schedule of one sample(); `owner`: a variable of the component that contains it."""
        span = condition["provenance"].get("span")
        clock = self._systems["clocks"]["clocks"][condition["operation"]["clock"]]
        operation = clock["operation"]
        if operation["kind"] != "periodic" or operation["anchor"] != "absolute":
            raise self._ir.error(span, "a clock that is not periodic is not supported")
        phase, period = (
            Fraction(operation["lattice"][name]["num"], operation["lattice"][name]["den"])
            for name in ("phase", "period")
        )
        place = self._ir.place(span)
        parts = self._arguments(span, owner)
        if parts is None:
            divisor = (phase * period.denominator).denominator * period.denominator
            grid = int(phase * divisor), int(period * divisor), divisor
            if max(grid) >= _EXACT:
                raise self._ir.error(span, "the instants of sample() are too fine to be exact")
            return Schedule(const(float(phase)), const(float(period)), grid, place)
        return Schedule(*parts, None, place)

    def _arguments(self, span: Mapping[str, int] | None, owner: str) -> tuple[Expr, Expr] | None:
        """Start and interval as expressions of parameters, None when they are numbers.

        The compiler evaluates them with the values of the model; an FMU must follow its own.
        """
        text = self._text(span)
        inside = re.fullmatch(r"sample\s*\((.*)\)", text, re.DOTALL)
        names = re.findall(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", inside.group(1) if inside else text)
        slots = {name: self._slots_of(name, owner) for name in names}
        if not any(slots.values()):
            return None
        try:
            tree = ast.parse(f"({inside.group(1)})" if inside else "", mode="eval").body
            if not isinstance(tree, ast.Tuple):
                raise ValueError(text)
            start, interval = (_expression(part, slots) for part in tree.elts)
        except (SyntaxError, ValueError):
            message = f"{text}: start and interval must be numbers, parameters and + - * / of them"
            raise self._ir.error(span, message) from None
        return start, interval

    def _text(self, span: Mapping[str, int] | None) -> str:
        if span is None or span["source"] not in self._ir.files:
            return ""
        text = self._ir.files[span["source"]][1].encode()[span["start"] : span["end"]].decode()
        return re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.DOTALL).strip()

    def _slots_of(self, name: str, owner: str) -> list[int]:
        """Slots of the parameters that `name` can mean, seen from the component of `owner`."""
        bindings = self._ir.solve["layout"]["bindings"]
        scopes = owner.split(".")[:-1]
        candidates = [".".join([*scopes[:k], name]) for k in range(len(scopes), -1, -1)]
        return [bindings[c]["P"]["index"] for c in candidates if "P" in bindings.get(c, {})]


def _expression(node: ast.expr, slots: Mapping[str, list[int]]) -> Expr:
    """Arithmetic of numbers and parameters; ValueError for anything else or a name of several."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return const(float(node.value))
    if isinstance(node, ast.Name | ast.Attribute):
        (slot,) = slots[ast.unparse(node)]
        return parameter(slot)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return apply("Neg", _expression(node.operand, slots))
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        return apply(
            _OPERATORS[type(node.op)],
            _expression(node.left, slots),
            _expression(node.right, slots),
        )
    raise ValueError(ast.unparse(node))
