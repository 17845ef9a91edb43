"""The variables of an FMU: names, causality, units and start values from the compiler's list."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from axisrig.fmus.equations.system import System
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.texts import Texts
from axisrig.fmus.writing.units import UnitError, read_unit

FMI_TYPE = {
    "real": "Float64",
    "integer": "Int32",
    "boolean": "Boolean",
    "enumeration": "Enumeration",
}

# Value references count from 1 in the order of ModelVariables, where the time comes first: an
# importer that takes a reference for an index from 1, or the other way round, finds the same one.
TIME_REFERENCE = 1
FIRST_REFERENCE = TIME_REFERENCE + 1

# A name of Modelica; the compiler's own variables have other signs in theirs.
_PART = r"(?:[A-Za-z_]\w*|'[^']+')(?:\[\d+(?:,\d+)*\])?"
_NAME = re.compile(rf"{_PART}(?:\.{_PART})*", re.ASCII)


@dataclass(frozen=True)
class Variable:
    """One variable that the FMU shows, a scalar or an array.

    reference: value reference, the place in ModelVariables from 1 (1 is the time). type: Float64,
    Int32, Boolean or Enumeration.
    causality, variability, initial: words of FMI 3.0 (initial None: not to be written).
    dimensions: of an array, row by row; elements: the names of its scalars. start: one number per
    element, None where the FMU computes it. vector, index: where the first element rests ("y" or
    "p"), the others follow. enumeration, literals: name and values of its type. declared: full name
    of the type that its declaration names, empty where it is a type of the language.
    """

    reference: int
    name: str
    type: str
    causality: str
    variability: str
    initial: str | None
    dimensions: tuple[int, ...]
    elements: tuple[str, ...]
    start: tuple[float, ...] | None
    unit: str | None
    minimum: float | None
    maximum: float | None
    nominal: float | None
    description: str
    vector: str
    index: int
    enumeration: str = ""
    literals: tuple[str, ...] = ()
    declared: str = ""

    @property
    def count(self) -> int:
        """Number of elements."""
        return len(self.elements)

    @property
    def settable(self) -> bool:
        """Whether the FMU takes a value for it, at least before the start."""
        if self.variability == "constant":
            return False
        return self.initial == "exact" or self.causality == "input"

    @property
    def slots(self) -> tuple[tuple[str, int], ...]:
        """Where each element rests."""
        return tuple((self.vector, self.index + k) for k in range(self.count))


def scalars(variables: Iterable[Variable]) -> list[Variable]:
    """The same variables with one scalar (`x[1]`) for each element, numbered anew."""
    found: list[Variable] = []
    for variable in variables:
        for number, name in enumerate(variable.elements):
            start = variable.start and (variable.start[number],)
            found.append(
                replace(
                    variable,
                    reference=FIRST_REFERENCE + len(found),
                    name=name,
                    dimensions=(),
                    elements=(name,),
                    start=start,
                    index=variable.index + number,
                )
            )
    return found


# --- values of attributes --------------------------------------------------------------------


def _constants(ir: Ir, expression: int) -> tuple[float, ...] | None:
    """The numbers of a literal or an array of such, None for anything else."""
    operation = ir.dae["expressions"][expression]["operation"]
    if operation["kind"] == "literal":
        ((_, value),) = operation["value"].items()
        return None if isinstance(value, str) else (float(value),)
    if operation["kind"] != "array":
        return None
    parts = [_constants(ir, element) for element in operation["elements"]]
    if any(part is None for part in parts):
        return None
    return tuple(value for part in parts if part for value in part)


def _numbers(ir: Ir, variable: Mapping[str, Any], name: str) -> tuple[float, ...] | None:
    """An attribute as the compiler evaluated it, one per element; None where there is none."""
    attributes = variable["attributes"]
    values = attributes[f"{name}_values"]
    if values is None:
        expression = attributes[name]
        values = None if expression is None else _constants(ir, expression)
    if values is None or any(value is None for value in values):
        return None
    numbers = tuple(float(value) for value in values)
    count = int(variable["scalar_count"])
    return numbers * count if len(numbers) == 1 else numbers


def _start(ir: Ir, variable: Mapping[str, Any]) -> tuple[float, ...]:
    """Start values of the elements; 0 where the model gives none."""
    count = int(variable["scalar_count"])
    given = [name for name in ("binding", "start") if variable["attributes"][name] is not None]
    for name in given:
        values = _numbers(ir, variable, name)
        if values is not None and len(values) == count:
            return values
    if given:
        span = variable["declaration"].get("span")
        raise ir.error(span, f"the start value of {variable['name']} is not a number")
    # The first literal of an enumeration has the number 1.
    return (1.0 if variable["value_type"]["scalar"] == "enumeration" else 0.0,) * count


def _refuse_moving(ir: Ir, variable: Mapping[str, Any], name: str) -> None:
    """Refuse an attribute that follows a parameter: it would rest at the default's value."""
    expression = variable["attributes"][name]
    if expression is not None:
        found = ir.dae["expressions"][expression]
        if found["variability"] != "constant":
            span = found["provenance"].get("span")
            message = f"{name} of {variable['name']} must not depend on a parameter"
            raise ir.error(span, message)


def _slots(ir: Ir, variable: Mapping[str, Any]) -> list[tuple[str, int]] | None:
    """Where the elements rest, None when the compiler gave them no place."""
    bindings = ir.solve["layout"]["bindings"]
    found = []
    for name in variable["scalar_names"]:
        if name not in bindings:
            return None
        ((vector, where),) = bindings[name].items()
        found.append((vector.lower(), int(where["index"])))
    return found or None


def start_vectors(ir: Ir, system: System) -> tuple[list[float], list[float]]:
    """Start values of y and p. Slots without a name (previous values, memory) start at 0."""
    vectors = {"y": [0.0] * system.y_count, "p": [0.0] * system.p_count}
    follows = {(a.vector, a.index) for a in system.initial}
    for variable in ir.dae["variables"]:
        slots = _slots(ir, variable)
        if slots is None or variable["value_type"]["scalar"] not in FMI_TYPE:
            continue
        if not follows.issuperset(slots):
            _refuse_moving(ir, variable, "start")
        for (vector, index), value in zip(slots, _start(ir, variable), strict=True):
            vectors[vector][index] = value
    for slot, vector, index in system.previous:
        vectors["p"][slot] = vectors[vector][index]
    return vectors["y"], vectors["p"]


# --- variables -------------------------------------------------------------------------------


def read_variables(ir: Ir, system: System, texts: Texts) -> list[Variable]:
    """Every variable that the FMU shows, in the order of declaration.

    A parameter with a plain number can be set, that of a component by its structured name
    (`stop.stiffness`); one that is bound to others is calculated; a final one with a number never
    changes. A state with a fixed start value can be set before the start. Constants are left out.
    Raises BuildError for unknown types and for units that are none.
    """
    computed = {(a.vector, a.index) for a in system.initial}
    variables: list[Variable] = []
    for variable in ir.dae["variables"]:
        slots = _slots(ir, variable)
        kind = variable["value_type"]["scalar"]
        if kind not in FMI_TYPE:
            message = f"{variable['name']} has the type {kind}, which is not supported"
            raise ir.error(variable["declaration"].get("span"), message)
        if variable["role"] == "constant" or slots is None or not _NAME.fullmatch(variable["name"]):
            continue
        vector, index = slots[0]
        if slots != [(vector, index + k) for k in range(len(slots))]:
            message = f"the elements of {variable['name']} are not side by side"
            raise ir.error(variable["declaration"].get("span"), message)
        reference = FIRST_REFERENCE + len(variables)
        found = _variable(ir, variable, reference, slots, computed)
        declared = _declared(ir, texts, variable, found.unit)
        variables.append(replace(found, declared=declared))
    return variables


def _declared(ir: Ir, texts: Texts, variable: Mapping[str, Any], unit: str | None) -> str:
    """The type of a real variable that the model description defines; empty when it has none."""
    declared = texts.declared_type(ir, variable) if unit else None
    is_same = declared is not None and texts.attributes(declared).get("unit") == unit
    return declared.name if declared is not None and is_same else ""


def _variable(
    ir: Ir,
    variable: Mapping[str, Any],
    reference: int,
    slots: Sequence[tuple[str, int]],
    computed: set[tuple[str, int]],
) -> Variable:
    """One variable with its FMI words."""
    attributes = variable["attributes"]
    kind = FMI_TYPE[variable["value_type"]["scalar"]]
    causality, variability, initial = _words(variable, kind, computed.isdisjoint(slots))
    starts = initial == "exact" or causality == "input"
    if causality != "local" and kind == "Float64":
        _refuse_moving(ir, variable, "minimum")
        _refuse_moving(ir, variable, "maximum")
    low, high = _numbers(ir, variable, "minimum"), _numbers(ir, variable, "maximum")
    nominal = _numbers(ir, variable, "nominal")
    found = ir.enumeration_of(variable["name"]) if kind == "Enumeration" else None
    enumeration, literals = found or ("", ())
    if kind == "Enumeration":
        # Without a known type the values are still there, only their names are not.
        kind = "Enumeration" if literals else "Int32"
    found_variable = Variable(
        reference=reference,
        name=variable["name"],
        type=kind,
        causality=causality,
        variability=variability,
        initial=initial,
        dimensions=tuple(variable["value_type"]["dimensions"]),
        elements=tuple(variable["scalar_names"]),
        start=_start(ir, variable) if starts else None,
        unit=_unit(ir, variable) if kind == "Float64" else None,
        minimum=1.0 if literals else _limit(low, min),
        maximum=float(len(literals)) if literals else _limit(high, max),
        nominal=abs(nominal[0]) if nominal and nominal[0] and len(set(nominal)) == 1 else None,
        description=" ".join((attributes["description"] or "").split()),
        vector=slots[0][0],
        index=slots[0][1],
        enumeration=enumeration,
        literals=literals,
    )
    _check_start(ir, variable, found_variable)
    return found_variable


def _check_start(ir: Ir, source: Mapping[str, Any], variable: Variable) -> None:
    """Refuse a start value outside the limits: the FMU would refuse it when it is set."""
    low = -math.inf if variable.minimum is None else variable.minimum
    high = math.inf if variable.maximum is None else variable.maximum
    for value in variable.start or ():
        if not low <= value <= high:
            span = source["declaration"].get("span")
            message = f"the start value {value:g} of {variable.name} is outside {low:g} .. {high:g}"
            raise ir.error(span, message)


def _words(variable: Mapping[str, Any], kind: str, is_free: bool) -> tuple[str, str, str | None]:
    """Causality, variability and initial. is_free: nothing computes the start value."""
    attributes, role = variable["attributes"], variable["role"]
    variability = "continuous" if kind == "Float64" else "discrete"
    if role == "parameter":
        if not is_free:
            return "calculatedParameter", "fixed", "calculated"
        return ("parameter", "fixed", "exact") if attributes["tunable"] else (
            "local", "constant", "exact"
        )  # fmt: skip
    if role == "input":
        return "input", variability, None
    if role in ("discrete_real", "discrete_value"):
        variability = "discrete"
    starts = role == "state" and attributes["fixed"] is True and is_free
    causality = "output" if attributes["causality"] == "output" else "local"
    return causality, variability, "exact" if starts else "calculated"


def _limit(values: tuple[float, ...] | None, widest: Any) -> float | None:
    """The limit that holds for all elements."""
    finite = values is not None and all(math.isfinite(value) for value in values)
    return float(widest(values)) if values and finite else None


def _unit(ir: Ir, variable: Mapping[str, Any]) -> str | None:
    """The unit, checked; None where the model gives none."""
    unit: str | None = variable["attributes"]["unit"] or None
    if unit is not None:
        try:
            read_unit(unit)
        except UnitError:
            span = variable["declaration"].get("span")
            raise ir.error(span, f"unit {unit} is not known") from None
    return unit
