"""Derivatives of expressions, and equations solved for their unknowns."""

from collections.abc import Callable, Mapping, Sequence

from axisrig.fmus.reading.expressions import (
    ONE,
    ZERO,
    Expr,
    apply,
    const,
    difference,
    in_order,
    negated,
    product,
    quotient,
    total,
)


class NotAffineError(Exception):
    """An equation that is not linear in its unknown."""


class NoDerivativeError(Exception):
    """An expression without a derivative here."""


def derivative(e: Expr, by: Expr) -> Expr:
    """The derivative of `e` by a leaf; jumps and kinks are left out, branches rest.

    Raises NoDerivativeError.
    """
    found: dict[Expr, Expr] = {}
    for node in in_order([e]):
        if node is by:
            found[node] = ONE
            continue
        inner = [found[arg] for arg in node.args]
        if all(part is ZERO for part in inner) or node.logical or node.kind in _FLAT:
            found[node] = ZERO
        elif node.kind == "Select":
            found[node] = apply("Select", node.args[0], inner[1], inner[2])
        elif node.kind in _RULES:
            found[node] = _RULES[node.kind](node, inner)
        else:
            raise NoDerivativeError(node.kind)
    return found[e]


def _chain(slope: Callable[[Expr, Expr], Expr]) -> Callable[[Expr, Sequence[Expr]], Expr]:
    """The rule of a function of one argument: slope(function, argument) times inner slope."""
    return lambda node, inner: product(slope(node, node.args[0]), inner[0])


def _square(e: Expr) -> Expr:
    return product(e, e)


def _of_power(node: Expr, inner: Sequence[Expr]) -> Expr:
    base, exponent = node.args
    less = apply("Pow", base, difference(exponent, ONE))
    result = product(product(exponent, less), inner[0])
    if inner[1] is not ZERO:
        result = total(result, product(product(node, apply("Log", base)), inner[1]))
    return result


def _of_quotient(node: Expr, inner: Sequence[Expr]) -> Expr:
    divisor = node.args[1]
    return quotient(difference(inner[0], product(node, inner[1])), divisor)


def _of_choice(compare: str) -> Callable[[Expr, Sequence[Expr]], Expr]:
    return lambda node, inner: apply("Select", apply(compare, *node.args), inner[0], inner[1])


def _of_angle(node: Expr, inner: Sequence[Expr]) -> Expr:
    y, x = node.args
    slope = difference(product(inner[0], x), product(inner[1], y))
    return quotient(slope, total(_square(x), _square(y)))


def _of_modulo(node: Expr, inner: Sequence[Expr]) -> Expr:
    whole = apply("Floor", quotient(*node.args))
    return difference(inner[0], product(whole, inner[1]))


_FLAT = frozenset({"Sign", "Floor", "Ceil", "Trunc"})
_TWO = const(2.0)
_RULES: Mapping[str, Callable[[Expr, Sequence[Expr]], Expr]] = {
    "Neg": lambda node, inner: negated(inner[0]),
    "Add": lambda node, inner: total(*inner),
    "Sub": lambda node, inner: difference(*inner),
    "Mul": lambda node, inner: total(
        product(inner[0], node.args[1]), product(node.args[0], inner[1])
    ),
    "Div": _of_quotient,
    "Pow": _of_power,
    "Min": _of_choice("Lt"),
    "Max": _of_choice("Gt"),
    "Atan2": _of_angle,
    "Mod": _of_modulo,
    "Abs": _chain(lambda f, u: apply("Sign", u)),
    "Sqrt": _chain(lambda f, u: quotient(ONE, product(_TWO, f))),
    "Exp": _chain(lambda f, u: f),
    "Log": _chain(lambda f, u: quotient(ONE, u)),
    "Log10": _chain(lambda f, u: quotient(const(0.4342944819032518), u)),
    "Sin": _chain(lambda f, u: apply("Cos", u)),
    "Cos": _chain(lambda f, u: negated(apply("Sin", u))),
    "Tan": _chain(lambda f, u: total(ONE, _square(f))),
    "Asin": _chain(lambda f, u: quotient(ONE, apply("Sqrt", difference(ONE, _square(u))))),
    "Acos": _chain(lambda f, u: quotient(const(-1.0), apply("Sqrt", difference(ONE, _square(u))))),
    "Atan": _chain(lambda f, u: quotient(ONE, total(ONE, _square(u)))),
    "Sinh": _chain(lambda f, u: apply("Cosh", u)),
    "Cosh": _chain(lambda f, u: apply("Sinh", u)),
    "Tanh": _chain(lambda f, u: difference(ONE, _square(f))),
}


def affine(e: Expr, unknown: Expr) -> tuple[Expr, Expr]:
    """Split `e` into slope and rest, e = slope*unknown + rest; neither reads the unknown.

    Raises NotAffineError.
    """
    found: dict[Expr, tuple[Expr, Expr]] = {}
    for node in in_order([e]):
        if node is unknown:
            found[node] = ONE, ZERO
            continue
        parts = [found[arg] for arg in node.args]
        if all(slope is ZERO for slope, _ in parts):
            found[node] = ZERO, node
        else:
            found[node] = _affine_node(node, parts)
    return found[e]


def _affine_node(node: Expr, parts: Sequence[tuple[Expr, Expr]]) -> tuple[Expr, Expr]:
    (s0, r0), (s1, r1) = parts[0], parts[-1]
    match node.kind:
        case "Neg":
            pair = (negated(s0), negated(r0))
        case "Add":
            pair = (total(s0, s1), total(r0, r1))
        case "Sub":
            pair = (difference(s0, s1), difference(r0, r1))
        case "Mul" if s1 is ZERO:
            pair = (product(s0, r1), product(r0, r1))
        case "Mul" if s0 is ZERO:
            pair = (product(r0, s1), product(r0, r1))
        case "Div" if s1 is ZERO:
            pair = (quotient(s0, r1), quotient(r0, r1))
        case "Select" if s0 is ZERO:
            (_, condition), (yes, rest), (no, other) = parts
            pair = (apply("Select", condition, yes, no), apply("Select", condition, rest, other))
        case _:
            raise NotAffineError
    return pair


def solve_for(residual: Expr, unknown: Expr) -> Expr:
    """Solve residual = 0 for the unknown.

    Raises NotAffineError when the residual is not linear in the unknown, or its slope is or may
    become 0.
    """
    slope, rest = affine(residual, unknown)
    if slope is ONE:
        return negated(rest)
    if slope.kind == "const" and slope.value == -1.0:
        return rest
    if _may_vanish(slope):
        raise NotAffineError
    return quotient(negated(rest), slope)


def _may_vanish(slope: Expr) -> bool:
    """Whether one branch of a slope is zero everywhere."""
    if slope.kind == "Select":
        return any(_may_vanish(part) for part in slope.args[1:])
    return slope.kind == "const" and slope.value == 0.0
