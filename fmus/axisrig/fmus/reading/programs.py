"""Register programs of the solve representation, read into expressions.

A program is straight-line code: each operation writes one or several registers in a row. Arrays are
row by row in registers that follow each other. What is not known here stops the build.
"""

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from axisrig.fmus.reading.expressions import (
    BINARY,
    COMPARE,
    ONE,
    UNARY,
    ZERO,
    Expr,
    UnsupportedError,
    choice,
    const,
    parameter,
    power,
    total,
    variable,
)
from axisrig.fmus.reading.ir import Ir

Op = Mapping[str, Any]
# Inlines a call: number of the function, registers, first register of each argument.
Call = Callable[[int, Mapping[int, Expr], Sequence[int]], Sequence[Expr]]
# The solution of linear equations: matrix row by row, right side.
Linear = Callable[[Sequence[Expr], Sequence[Expr]], Expr]

_OPERANDS = ("arg", "lhs", "rhs", "cond", "if_true", "if_false")
_INNER: Mapping[str, Mapping[str, str]] = {"Unary": UNARY, "Binary": BINARY, "Compare": COMPARE}
_NUMBERS = {"positive_infinity": math.inf, "negative_infinity": -math.inf, "nan": math.nan}


def read_program(
    ops: Sequence[Op], call: Call, linear: Linear, captures: Sequence[Expr] = ()
) -> dict[int, Expr]:
    """Turn register code into one expression for each output index.

    call, linear: what a function call and linear equations mean. captures: values that a
    branch takes from around it.
    Raises UnsupportedError for an op, operator or form that is not known.
    """
    return _Reader(call, linear, captures).read(ops)


class _Reader:
    def __init__(self, call: Call, linear: Linear, captures: Sequence[Expr]) -> None:
        self._call, self._linear, self._captures = call, linear, captures
        self._registers: dict[int, Expr] = {}
        self._systems: dict[tuple[int, int], Expr] = {}  # by their registers

    def read(self, ops: Sequence[Op]) -> dict[int, Expr]:
        outputs: dict[int, Expr] = {}
        for op in ops:
            kind = op["kind"]
            if kind == "StoreOutput":
                outputs[op["output_index"]] = self._registers[op["src"]]
            elif kind == "StoreOutputRange":
                for offset, index in enumerate(op["output_indices"]):
                    outputs[index] = self._registers[op["start"] + offset * op["stride"]]
            else:
                results = self._results(op)
                first = op["dst_start"] if "dst_start" in op else op["dst"]
                self._registers.update(enumerate(results, first))
        return outputs

    def _results(self, op: Op) -> Sequence[Expr]:
        """What an operation writes into its registers."""
        kind = op["kind"]
        operator = op.get("operator", kind)
        if kind in _INNER and operator in _INNER[kind]:
            parts = [self._registers[op[name]] for name in _OPERANDS if name in op]
            return [_joined(operator, parts)]
        words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", kind).lower()  # LoadP: _op_load_p
        method = getattr(self, f"_op_{words}", None)
        if method is None or op.get("lanes", 1) != 1:
            text = kind if operator == kind else f"{kind} {operator}"
            raise UnsupportedError(f"the operation {text} of the compiler")
        results: Sequence[Expr] = method(op)
        return results

    def _several(self, start: int, count: int, stride: int = 1) -> list[Expr]:
        return [self._registers[start + k * stride] for k in range(count)]

    # --- leaves and scalars

    def _op_const(self, op: Op) -> list[Expr]:
        if op["value_class"] == "finite":
            return [const(float(op["value"]))]
        if op["value_class"] not in _NUMBERS:
            raise UnsupportedError(f"a number of the class {op['value_class']}")
        return [const(_NUMBERS[op["value_class"]])]

    def _op_load_time(self, op: Op) -> list[Expr]:
        return [Expr("time")]

    def _op_load_y(self, op: Op) -> list[Expr]:
        return [variable(op["index"])]

    def _op_load_p(self, op: Op) -> list[Expr]:
        return [parameter(op["index"])]

    def _op_move(self, op: Op) -> list[Expr]:
        return [self._registers[op["src"]]]

    def _op_select(self, op: Op) -> list[Expr]:
        return [choice(*(self._registers[op[name]] for name in ("cond", "if_true", "if_false")))]

    # --- arrays

    def _op_tensor_load(self, op: Op) -> list[Expr]:
        if op["input"] not in ("Y", "P"):
            raise UnsupportedError(f"an array from {op['input']}")
        leaf = variable if op["input"] == "Y" else parameter
        return [leaf(op["input_start"] + k) for k in range(op["count"])]

    def _op_load_indexed_p(self, op: Op) -> list[Expr]:
        values = [parameter(op["base"] + k) for k in range(op["count"])]
        return [_picked(values, self._registers[op["index_ref"]], first=0)]

    def _op_load_indexed_register(self, op: Op) -> list[Expr]:
        stride, dimensions = op["stride"], op["dimensions"]
        values = self._several(op["base"], math.prod(dimensions), stride)
        for extent, index in zip(dimensions, op["indices"], strict=True):
            ((how, what),) = index.items()
            count = len(values) // extent
            rows = [values[k * count : (k + 1) * count] for k in range(extent)]
            if how == "Constant":
                values = rows[what - 1]
            elif how == "Runtime":
                index_value = self._registers[what]
                columns = zip(*rows, strict=True)
                values = [_picked(list(column), index_value, first=1) for column in columns]
            else:
                raise UnsupportedError(f"an array index of the form {how}")
        return values

    def _op_tensor_binary(self, op: Op) -> list[Expr]:
        left = self._several(op["lhs_start"], op["count"], op["lhs_stride"])
        right = self._several(op["rhs_start"], op["count"], op["rhs_stride"])
        if op["operator"] not in BINARY:
            raise UnsupportedError(f"the array operation {op['operator']}")
        return [Expr(op["operator"], pair) for pair in zip(left, right, strict=True)]

    def _op_matrix_multiply(self, op: Op) -> list[Expr]:
        rows, inner, columns = op["rows"], op["inner"], op["columns"]
        left = self._several(op["lhs_start"], rows * inner)
        right = self._several(op["rhs_start"], inner * columns)
        return [
            _dot(left[i * inner : (i + 1) * inner], right[j::columns])
            for i in range(rows)
            for j in range(columns)
        ]

    def _op_dot_product(self, op: Op) -> list[Expr]:
        left = self._several(op["lhs_start"], op["count"], op.get("lhs_stride", 1))
        right = self._several(op["rhs_start"], op["count"], op.get("rhs_stride", 1))
        return [_dot(left, right)]

    def _op_tensor_cross(self, op: Op) -> list[Expr]:
        a, b = self._several(op["lhs_start"], 3), self._several(op["rhs_start"], 3)
        pairs = ((1, 2), (2, 0), (0, 1))
        return [
            Expr("Sub", (Expr("Mul", (a[i], b[j])), Expr("Mul", (a[j], b[i])))) for i, j in pairs
        ]

    def _op_tensor_transpose(self, op: Op) -> list[Expr]:
        rows, columns, width = op["rows"], op["columns"], op["element_width"]
        values = self._several(op["src_start"], rows * columns * width)
        return [
            values[(i * columns + j) * width + k]
            for j in range(columns)
            for i in range(rows)
            for k in range(width)
        ]

    def _op_tensor_concatenate(self, op: Op) -> list[Expr]:
        """Side by side along one axis: the parts of each source for each index before the axis."""
        axis, result = op["axis"], op["dimensions"]
        outer = math.prod(result[:axis])
        sources = []
        for source in op["sources"]:
            size = math.prod(source["dimensions"])
            values = self._several(source["start"], size)
            sources.append((values, size // outer))
        return [
            part
            for i in range(outer)
            for values, width in sources
            for part in values[i * width : (i + 1) * width]
        ]

    def _op_tensor_fill(self, op: Op) -> list[Expr]:
        return [self._registers[op["value_start"]]] * int(op["count"])

    def _op_tensor_identity(self, op: Op) -> list[Expr]:
        size = op["size"]
        return [ONE if i == j else ZERO for i in range(size) for j in range(size)]

    def _op_linear_solve_component(self, op: Op) -> list[Expr]:
        key = op["matrix_start"], op["rhs_start"]
        if key not in self._systems:
            matrix = self._several(op["matrix_start"], op["n"] ** 2)
            self._systems[key] = self._linear(matrix, self._several(op["rhs_start"], op["n"]))
        return [Expr("Component", (self._systems[key],), index=op["component"])]

    # --- branches and calls

    def _op_function_conditional(self, op: Op) -> list[Expr]:
        """`if` with several results: nested selections, the first true arm wins."""
        captures = self._several(op["capture_start"], op["capture_count"])

        def outputs(program: Op) -> list[Expr]:
            found = read_program(program["ops"], self._call, self._linear, captures)
            return [found[index] for index in range(len(found))]

        results = outputs(op["fallback"])
        for arm in reversed(op["arms"]):
            condition = outputs(arm["condition"])[0]
            chosen = outputs(arm["result"])
            results = [choice(condition, yes, no) for yes, no in zip(chosen, results, strict=True)]
        if len(results) != sum(op["target_widths"]):
            raise UnsupportedError("a conditional of another shape")
        return results

    def _op_load_function_conditional_capture(self, op: Op) -> list[Expr]:
        return [self._captures[op["index"]]]

    def _op_load_function_conditional_capture_range(self, op: Op) -> Sequence[Expr]:
        return self._captures[op["index_start"] : op["index_start"] + op["count"]]

    def _op_pure_call(self, op: Op) -> Sequence[Expr]:
        return self._call(op["owner"], self._registers, op["input_starts"])


def _joined(operator: str, parts: Sequence[Expr]) -> Expr:
    """A scalar operation; what the compiler spells out as a - floor(a/b)*b is mod(a, b) again."""
    if operator == "Pow":
        return power(*parts)
    if operator == "Sub" and parts[1].kind == "Mul" and not parts[0].moves:
        whole, b = parts[1].args
        if whole is Expr("Floor", [Expr("Div", [parts[0], b])]):
            return Expr("Mod", [parts[0], b])
    return Expr(operator, parts)


def _dot(left: Sequence[Expr], right: Sequence[Expr]) -> Expr:
    products = [Expr("Mul", pair) for pair in zip(left, right, strict=True)]
    result = ZERO
    for one in products:
        result = total(result, one)
    return result


def _picked(values: Sequence[Expr], index: Expr, first: int) -> Expr:
    """values[index - first]; not a number where the index is outside."""
    result = const(math.nan)
    for number in range(len(values) - 1, -1, -1):
        condition = Expr("Eq", (index, const(number + first)))
        result = choice(condition, values[number], result)
    return result


def start_programs(ir: Ir) -> list[dict[str, Any]]:
    """The programs of the initial residual in the form of a plan.

    Raises BuildError for a form that is not known.
    """
    try:
        return plain_programs(ir.solve["initialization"]["residual"])
    except UnsupportedError as error:
        raise ir.error(None, f"{error} is not supported") from error


def plain_programs(residual: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The programs of an initial residual in the form of a plan.

    The compiler prepares no plan for these; its own form names the same operations.
    Raises UnsupportedError for any other form.
    """
    found = []
    for node in residual["nodes"]:
        ((kind, content),) = node.items()
        if kind != "ScalarPrograms":
            raise UnsupportedError(f"a residual of the form {kind}")
        indices = iter(content["output_indices"])
        spans = content.get("program_spans") or [None] * len(content["programs"])
        for ops, span in zip(content["programs"], spans, strict=True):
            found.append({"ops": _plain_ops(ops, indices), "span": span})
    return found


def _plain_ops(ops: Sequence[Mapping[str, Any]], indices: Iterator[int]) -> list[dict[str, Any]]:
    """Operations in the form of a plan; `indices` numbers the outputs."""
    plain = []
    for raw in ops:
        ((kind, content),) = raw.items()
        op = {"kind": kind, **content}
        if "op" in op:
            op["operator"] = op.pop("op")
        if kind == "Const":
            finite = isinstance(op["value"], int | float) and math.isfinite(op["value"])
            op["value_class"] = "finite" if finite else str(op["value"])
        elif kind == "PureCall":
            op["owner"] = op["site"]["owner"]
        elif kind == "StoreOutput":
            op["output_index"] = next(indices)
        elif kind == "StoreOutputRange":
            op["output_indices"] = [next(indices) for _ in range(op["count"])]
        elif kind == "FunctionConditional":
            program = op.pop("program")
            op |= program
            op["fallback"] = {"ops": _plain_ops(program["fallback"], itertools.count())}
            op["arms"] = [
                {
                    part: {"ops": _plain_ops(arm[part], itertools.count())}
                    for part in ("condition", "result")
                }
                for arm in program["arms"]
            ]
        plain.append(op)
    return plain
