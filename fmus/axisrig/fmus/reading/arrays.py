"""Values in Modelica functions, scalars and arrays, and what acts on whole arrays."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from axisrig.fmus.reading.expressions import ONE, ZERO, Expr, UnsupportedError, apply, const


@dataclass(frozen=True)
class Value:
    """A value of some shape: its scalars row by row. dimensions: () for a scalar."""

    parts: Sequence[Expr]
    dimensions: tuple[int, ...] = ()

    @property
    def scalar(self) -> Expr:
        """The only part."""
        if len(self.parts) != 1:
            raise UnsupportedError("an array in place of a number")
        return self.parts[0]


def whole(index: Expr) -> int:
    """A size or an index as a number; UnsupportedError where it is not known at once."""
    if index.kind != "const":
        raise UnsupportedError("an array size or index that moves")
    return int(index.value)


def elementwise(kind: str, *values: Value) -> Value:
    """An operator on values of one shape; scalars go with every element."""
    shaped = next((value for value in values if value.dimensions), values[0])
    count = len(shaped.parts)
    columns = [v.parts if v.dimensions else [v.scalar] * count for v in values]
    return Value([apply(kind, *parts) for parts in zip(*columns, strict=True)], shaped.dimensions)


def matrix_product(left: Value, right: Value) -> Value:
    """left*right of vectors and matrices; two vectors give the scalar product."""
    inner = left.dimensions[-1]
    columns = right.dimensions[1] if len(right.dimensions) == 2 else 1
    parts = []
    for i in range(len(left.parts) // inner):
        for j in range(columns):
            one = ZERO
            for k in range(inner):
                factors = left.parts[i * inner + k], right.parts[k * columns + j]
                one = apply("Add", one, apply("Mul", *factors))
            parts.append(one)
    return Value(parts, left.dimensions[:-1] + right.dimensions[1:])


def indexed(base: Value, subscripts: Sequence[Value | None]) -> Value:
    """Elements of an array; an index that moves becomes a chain of selections."""
    if not subscripts:
        return base
    extent, inner = base.dimensions[0], base.dimensions[1:]
    size = math.prod(inner)
    rows = [
        indexed(Value(base.parts[k * size : (k + 1) * size], inner), subscripts[1:])
        for k in range(extent)
    ]
    rest = rows[0].dimensions
    first = subscripts[0]
    if first is None:
        return Value([part for row in rows for part in row.parts], (extent, *rest))
    picked = [_row(rows, index) for index in first.parts]
    parts = [part for row in picked for part in row.parts]
    return Value(parts, (*first.dimensions, *rest))


def _row(rows: Sequence[Value], index: Expr) -> Value:
    if index.kind == "const":
        number = int(index.value)
        if not 1 <= number <= len(rows):
            raise UnsupportedError(f"the index {number} of an array of {len(rows)}")
        return rows[number - 1]
    parts = [const(math.nan) for _ in rows[0].parts]
    for number in range(len(rows), 0, -1):
        condition = apply("Eq", index, const(number))
        pairs = zip(rows[number - 1].parts, parts, strict=True)
        parts = [apply("Select", condition, yes, no) for yes, no in pairs]
    return Value(parts, rows[0].dimensions)


def _transposed(value: Value) -> Value:
    rows, columns = value.dimensions
    parts = [value.parts[i * columns + j] for j in range(columns) for i in range(rows)]
    return Value(parts, (columns, rows))


def _filled(value: Value, *extents: Value) -> Value:
    dimensions = tuple(whole(extent.scalar) for extent in extents)
    return Value([value.scalar] * math.prod(dimensions), dimensions)


def _identity(size: Value) -> Value:
    n = whole(size.scalar)
    return Value([ONE if i == j else ZERO for i in range(n) for j in range(n)], (n, n))


def _diagonal(values: Value) -> Value:
    n = len(values.parts)
    parts = [values.parts[i] if i == j else ZERO for i in range(n) for j in range(n)]
    return Value(parts, (n, n))


def _cross(a: Value, b: Value) -> Value:
    pairs = ((1, 2), (2, 0), (0, 1))
    products = [
        (apply("Mul", a.parts[i], b.parts[j]), apply("Mul", a.parts[j], b.parts[i]))
        for i, j in pairs
    ]
    return Value([apply("Sub", *pair) for pair in products], (3,))


def _below(*values: Value) -> Value:
    """cat(1, ...) of matrices."""
    parts = [part for value in values for part in value.parts]
    columns = values[0].dimensions[1:]
    return Value(parts, (sum(v.dimensions[0] if v.dimensions else 1 for v in values), *columns))


def _beside(*values: Value) -> Value:
    """cat(2, ...); a scalar is a matrix of one row."""
    shapes = [v.dimensions if len(v.dimensions) == 2 else (len(v.parts), 1) for v in values]
    rows = shapes[0][0]
    parts = [
        part
        for i in range(rows)
        for value, shape in zip(values, shapes, strict=True)
        for part in value.parts[i * shape[1] : (i + 1) * shape[1]]
    ]
    return Value(parts, (rows, sum(shape[1] for shape in shapes)))


def _divided(a: Value, b: Value) -> Value:
    """div(a, b): the whole part of the quotient, towards zero."""
    return elementwise("Trunc", elementwise("Div", a, b))


def _remainder(a: Value, b: Value) -> Value:
    """rem(a, b): what div(a, b) leaves."""
    return elementwise("Sub", a, elementwise("Mul", _divided(a, b), b))


ARRAYS: Mapping[str, Callable[..., Value]] = {
    "div": _divided,
    "rem": _remainder,
    "transpose": _transposed,
    "fill": _filled,
    "zeros": lambda *extents: _filled(Value([ZERO]), *extents),
    "ones": lambda *extents: _filled(Value([ONE]), *extents),
    "identity": _identity,
    "diagonal": _diagonal,
    "cross": _cross,
    "promoted_cat1": _below,
    "promoted_cat2": _beside,
}
