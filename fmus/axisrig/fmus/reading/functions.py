"""Calls of Modelica functions, inlined into expressions.

The compiler keeps a function as definitions that are each written once; loops are folds over a
fixed range. A call is replaced by what the definitions give for its arguments.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from axisrig.fmus.reading.arrays import ARRAYS, Value, elementwise, indexed, matrix_product, whole
from axisrig.fmus.reading.calls import read_owners
from axisrig.fmus.reading.expressions import ONE, UNARY, ZERO, Expr, UnsupportedError, apply, const
from axisrig.fmus.reading.ir import Ir

MAX_NODES = 200_000  # of one call, with everything that it calls

_UNARY = {"negate": "Neg", "not": "Not"}
_BINARY = {
    "add": "Add",
    "subtract": "Sub",
    "multiply": "Mul",
    "divide": "Div",
    "power": "Pow",
    "less": "Lt",
    "less_equal": "Le",
    "greater": "Gt",
    "greater_equal": "Ge",
    "equal": "Eq",
    "not_equal": "Ne",
    "and": "And",
    "or": "Or",
}
_SCALAR = {kind.lower(): kind for kind in (*UNARY, "Atan2", "Mod", "Min", "Max")} | {
    "integer": "Floor"
}
_FOLDS = {"sum": ("Add", ZERO), "product": ("Mul", ONE), "min": ("Min", None), "max": ("Max", None)}
_THROUGH = {"no_event": 0, "smooth": 1, "homotopy": 0, "scalar": 0, "vector": 0, "matrix": 0}
_STATEMENTS = {"assignment", "assignment_group", "for"}


@dataclass
class _Frame:
    """Where an expression is evaluated: the arguments, and one pass of each loop around it."""

    arguments: Sequence[Value]
    parent: "_Frame | None" = None
    domain: int | None = None
    binders: Sequence[int] = ()
    carried: Mapping[tuple[int, int], Value] = field(default_factory=dict)
    done: dict[int | tuple[str, int, int], Value] = field(default_factory=dict)

    def of(self, domain: int | None) -> "_Frame":
        """The frame of a loop around this one; the outermost for None."""
        frame = self
        while frame.domain != domain:
            if frame.parent is None:
                raise UnsupportedError("a loop variable outside its loop")
            frame = frame.parent
        return frame


class Functions:
    """The functions of one model."""

    def __init__(self, ir: Ir) -> None:
        self._functions: Sequence[Mapping[str, Any]] = ir.dae["functions"]
        self._expressions: Sequence[Mapping[str, Any]] = ir.dae["expressions"]
        self._domains: Sequence[Mapping[str, Any]] = ir.dae["domains"]
        self._types: Sequence[Mapping[str, Any]] = ir.dae["value_types"]
        self._owners = read_owners(ir)
        self._open: list[int] = []
        self._nodes = 0

    def call(self, owner: int, registers: Mapping[int, Expr], starts: Sequence[int]) -> list[Expr]:
        """All results of the call with number `owner`, one after the other.

        Raises UnsupportedError for anything in the function that has no meaning here.
        """
        number = self._owners[owner]
        function = self._functions[number]
        if len(starts) != len(function["parameter_types"]):
            raise UnsupportedError(f"a call of {function['name']} with other arguments")
        arguments = []
        for kind, start in zip(function["parameter_types"], starts, strict=True):
            described = self._types[kind]
            shape = described.get("value_type", described)
            dimensions = tuple(shape["dimensions"])
            if shape["scalar"] == "record":
                raise UnsupportedError(f"a record as argument of {function['name']}")
            parts = [registers[start + k] for k in range(math.prod(dimensions))]
            arguments.append(Value(parts, dimensions))
        self._nodes = 0
        results = self._results(number, arguments)
        return [part for result in results for part in result.parts]

    def _results(self, owner: int, arguments: Sequence[Value]) -> list[Value]:
        function = self._functions[owner]
        name = function["name"]
        if function["external"] is not None:
            raise UnsupportedError(f"the external function {name}")
        if owner in self._open:
            raise UnsupportedError(f"the function {name}, which calls itself,")
        if not _only_known(function["statements"]):
            raise UnsupportedError(f"a statement in the function {name}")
        self._open.append(owner)
        frame = _Frame(arguments)
        results = [self._definition(owner, number, frame) for number in function["results"]]
        self._open.pop()
        return results

    def _definition(self, owner: int, number: int, frame: _Frame) -> Value:
        return self._value(self._functions[owner]["definitions"][number]["rhs"], frame)

    def _value(self, number: int, frame: _Frame) -> Value:
        expression = self._expressions[number]
        home = frame.of(expression["binder_domain"])
        if number not in home.done:
            self._nodes += 1
            if self._nodes > MAX_NODES:
                raise UnsupportedError("a function of this length")
            operation = expression["operation"]
            method = getattr(self, f"_of_{operation['kind']}", None)
            if method is None:
                raise UnsupportedError(f"{operation['kind']} in a function")
            result: Value = method(operation, home)
            home.done[number] = result
        return home.done[number]

    def _values(self, numbers: Sequence[int], frame: _Frame) -> list[Value]:
        return [self._value(number, frame) for number in numbers]

    # --- leaves

    def _of_literal(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        ((kind, value),) = operation["value"].items()
        if kind not in ("real", "integer", "boolean"):
            raise UnsupportedError(f"a {kind} in a function")
        return Value([const(float(value))])

    def _of_coordinate(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        coordinate = operation["coordinate"]
        if coordinate["kind"] == "function_parameter":
            return frame.arguments[int(coordinate["ordinal"])]
        if coordinate["kind"] == "binder":
            binders = frame.of(coordinate["domain"]).binders
            return Value([const(float(binders[coordinate["ordinal"]]))])
        raise UnsupportedError(f"{coordinate['kind']} in a function")

    def _of_function_value(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        owner, number = operation["function"], operation["definition"]
        for fold in self._functions[owner]["folds"]:
            for carried, place in enumerate(fold["parameter_definitions"]):
                if place == number:
                    return self._carried(fold["ordinal"], carried, frame)
        return self._definition(owner, number, frame)

    def _of_function_fold_parameter(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        return self._carried(operation["fold"], operation["carried"], frame)

    def _carried(self, fold: int, number: int, frame: _Frame) -> Value:
        around: _Frame | None = frame
        while around is not None:
            if (fold, number) in around.carried:
                return around.carried[fold, number]
            around = around.parent
        raise UnsupportedError("a loop variable outside its loop")

    def _of_function_fold_output(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        owner = operation["function"]
        fold = self._functions[owner]["folds"][operation["fold"]]
        key = ("loop", operation["fold"], operation["carried"])
        if key not in frame.done:  # all outputs of one loop come from one run of it
            values = [self._definition(owner, n, frame) for n in fold["initial_definitions"]]
            for binders in self._passes(fold["domain"]):
                carried = {(fold["ordinal"], k): value for k, value in enumerate(values)}
                inner = _Frame(frame.arguments, frame, fold["domain"], binders, carried)
                values = [self._definition(owner, n, inner) for n in fold["update_definitions"]]
            for k, value in enumerate(values):
                frame.done["loop", operation["fold"], k] = value
        return frame.done[key]

    def _passes(self, domain: int) -> list[tuple[int, ...]]:
        binders = self._domains[domain]["domain"]["binders"]
        ranges = []
        for binder in binders:
            step = binder["step"]
            ranges.append(range(binder["lower"], binder["upper"] + (1 if step > 0 else -1), step))
        return list(itertools.product(*ranges))

    # --- operators

    def _of_unary(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        value = self._value(operation["operand"], frame)
        if operation["operator"] == "plus":
            return value
        kind = _known(_UNARY, operation["operator"])
        return Value([apply(kind, part) for part in value.parts], value.dimensions)

    def _of_binary(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        left, right = self._values([operation["lhs"], operation["rhs"]], frame)
        name = operation["operator"]
        by_element = name.startswith("elementwise_")
        kind = _known(_BINARY, name.removeprefix("elementwise_"))
        if kind == "Mul" and not by_element and left.dimensions and right.dimensions:
            return matrix_product(left, right)
        if kind == "Pow" and not by_element and left.dimensions:
            raise UnsupportedError("the power of a matrix")
        return elementwise(kind, left, right)

    def _of_conditional(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        """Operands: condition, value, ..., else value. Only what can be chosen is evaluated."""
        *pairs, last = operation["operands"]
        chosen: list[tuple[Expr, Value]] = []
        result: Value | None = None
        for condition_number, number in zip(pairs[::2], pairs[1::2], strict=True):
            condition = self._value(condition_number, frame).scalar
            if condition.kind == "const":
                if condition.value != 0.0:
                    result = self._value(number, frame)
                    break
                continue
            chosen.append((condition, self._value(number, frame)))
        result = result or self._value(last, frame)
        for condition, value in reversed(chosen):
            pairs_of_parts = zip(value.parts, result.parts, strict=True)
            parts = [apply("Select", condition, yes, no) for yes, no in pairs_of_parts]
            result = Value(parts, value.dimensions)
        return result

    def _of_call(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        arguments = self._values(operation["arguments"], frame)
        return self._results(operation["function"], arguments)[int(operation["output"])]

    # --- arrays and records

    def _of_array(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        values = self._values(operation["elements"], frame)
        parts = [part for value in values for part in value.parts]
        inner = values[0].dimensions if values else ()
        return Value(parts, (len(values), *inner))

    def _of_range(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        start, stop = operation["start"]["value"], operation["stop"]["value"]
        explicit = operation["explicit_step"]
        step = 1 if explicit is None else explicit["value"]
        count = max(0, math.floor((stop - start) / step + 1e-9) + 1)
        return Value([const(float(start + k * step)) for k in range(count)], (count,))

    def _of_comprehension(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        domain = operation["domain"]
        values = [
            self._value(operation["body"], _Frame(frame.arguments, frame, domain, binders))
            for binders in self._passes(domain)
        ]
        extents = tuple(self._domains[domain]["extents"])
        parts = [part for value in values for part in value.parts]
        return Value(parts, extents + (values[0].dimensions if values else ()))

    def _of_record(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        values = self._values(operation["fields"], frame)
        if any(value.dimensions for value in values):
            raise UnsupportedError("a record with arrays in a function")
        return Value([value.scalar for value in values])

    def _of_field(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        return Value([self._value(operation["base"], frame).parts[operation["field"]]])

    def _of_index(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        base = self._value(operation["base"], frame)
        return indexed(base, [self._subscript(s, frame) for s in operation["subscripts"]])

    def _subscript(self, subscript: Mapping[str, Any], frame: _Frame) -> Value | None:
        if subscript["kind"] == "colon":
            return None
        if "expression" not in subscript:
            raise UnsupportedError(f"a subscript of the kind {subscript['kind']}")
        return self._value(subscript["expression"], frame)

    def _of_array_update(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        raise UnsupportedError("the assignment to one element of an array in a function")

    def _of_builtin(self, operation: Mapping[str, Any], frame: _Frame) -> Value:
        name = operation["builtin"]
        if name == "size":
            return self._size(operation["arguments"], frame)
        values = self._values(operation["arguments"], frame)
        if name in _THROUGH:
            return values[_THROUGH[name]]
        if name in _FOLDS and len(values) == 1:
            kind, start = _FOLDS[name]
            parts = list(values[0].parts)
            result = start if start is not None else parts.pop(0)
            for part in parts:
                result = apply(kind, result, part)
            return Value([result])
        if name in ARRAYS:
            return ARRAYS[name](*values)
        if name not in _SCALAR:
            raise UnsupportedError(f"{name}() in a function")
        return elementwise(_SCALAR[name], *values)

    def _size(self, numbers: Sequence[int], frame: _Frame) -> Value:
        dimensions = self._value(numbers[0], frame).dimensions
        if len(numbers) == 1:
            return Value([const(d) for d in dimensions], (len(dimensions),))
        return Value([const(dimensions[whole(self._value(numbers[1], frame).scalar) - 1])])


def _only_known(statements: Sequence[Mapping[str, Any]]) -> bool:
    return all(
        s["kind"] in _STATEMENTS and _only_known(s.get("statements", ())) for s in statements
    )


def _known(table: Mapping[str, str], operator: str) -> str:
    if operator not in table:
        raise UnsupportedError(f"the operator {operator} in a function")
    return table[operator]
