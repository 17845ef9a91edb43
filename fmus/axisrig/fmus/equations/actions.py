"""assert() and terminate(): when they act and what they say."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from axisrig.fmus.reading.expressions import Expr, UnsupportedError, apply, const
from axisrig.fmus.reading.ir import Ir, Source

# How far a start value may be from what the equations give, in the unit of the variable.
START_TOLERANCE = 1e-6
_KINDS = {"Assert": "assert", "Warning": "warning", "Terminate": "terminate"}
_DIGITS = 6  # of String(r), as the language says


@dataclass(frozen=True)
class Action:
    """An assertion, a warning or the end of the simulation.

    kind: "assert", "warning" or "terminate". condition: acts when true. text: format of printf;
    values: its arguments with their type, "Real", "Integer" or "Boolean". at_start: only at the end
    of the initialization. memory: slot of p that holds whether a warning has been given.
    """

    kind: str
    condition: Expr
    text: str
    values: Sequence[tuple[str, Expr]]
    place: Source | None
    at_start: bool = False
    memory: int = -1


def read_message(
    action: Mapping[str, Any], read: Callable[[Sequence[Mapping[str, Any]]], Expr]
) -> tuple[str, list[tuple[str, Expr]]]:
    """Format and values of a message. read: turns the program of a value into an expression.

    Raises UnsupportedError for values and formats that are not known.
    """
    text = ""
    values = []
    for part in action["message"]["parts"]:
        ((kind, content),) = part.items()
        if kind == "Text":
            text += content.replace("%", "%%")
        elif kind == "Conversion" and content["source"] in ("Real", "Integer", "Boolean"):
            text += _conversion(content)
            values.append((content["source"], read(content["value"])))
        else:
            raise UnsupportedError("this part of a message")
    return text, values


def _conversion(content: Mapping[str, Any]) -> str:
    """The format of one value."""
    ((form, options),) = content["format"].items()
    if form != "Options":
        raise UnsupportedError("a format string in a message")
    given = {name: _constant(value) for name, value in options.items() if value is not None}
    width = str(int(given.get("minimum_length", 0)) or "")
    left = "-" if width and given.get("left_justified", 1.0) else ""
    if content["source"] == "Boolean":
        return f"%{left}{width}s"
    if content["source"] == "Integer":
        return f"%{left}{width}.0f"
    return f"%{left}{width}.{int(given.get('significant_digits', _DIGITS))}g"


def _constant(value: Any) -> float:
    """A number in the options of a format."""
    while isinstance(value, Mapping | list) and value:
        value = next(iter(value.values())) if isinstance(value, Mapping) else value[0]
    if not isinstance(value, int | float):
        raise UnsupportedError("a format that is not a number in a message")
    return float(value)


def start_check(residual: Expr, place: Source | None) -> Action:
    """A start value is given although equations decide it: both must agree."""
    condition = apply("Gt", apply("Abs", residual), const(START_TOLERANCE))
    message = "an initial equation or fixed start value contradicts the other equations"
    return Action("assert", condition, message, [], place, at_start=True)


def actions_of(ir: Ir) -> Sequence[Mapping[str, Any]]:
    """The actions of a model. Raises BuildError for one that is not known."""
    actions: Sequence[Mapping[str, Any]] = ir.solve["events"]["actions"]
    for action in actions:
        if action["kind"] not in _KINDS:
            raise ir.error(action.get("span"), f"{action['kind']} is not supported")
    return actions


def kind_of(action: Mapping[str, Any]) -> str:
    """The kind of an action in the words of `Action`."""
    return _KINDS[action["kind"]]
