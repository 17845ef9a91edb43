"""The variables of an FMU: names, causality, units and start values from the compiler's list."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmus.ir import Ir
from fmus.system import System

UNITS_FILE = Path(__file__).parent / "units.csv"
FMI_TYPE = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}


@dataclass(frozen=True)
class Variable:
    """One variable that the FMU shows.

    reference: value reference (0 is the time). type: Float64, Int32 or Boolean. causality,
    variability: words of FMI 3.0. start: number, None where the FMU computes it. vector, index:
    where the value rests ("y" or "p").
    """

    reference: int
    name: str
    type: str
    causality: str
    variability: str
    start: float | None
    unit: str | None
    minimum: float | None
    maximum: float | None
    description: str
    vector: str
    index: int


def read_units() -> dict[str, dict[str, str]]:
    """The known units with their SI exponents, by unit text."""
    with UNITS_FILE.open(encoding="utf-8", newline="") as file:
        return {row["unit"]: row for row in csv.DictReader(file)}


def _single(ir: Ir, variable: Mapping[str, Any]) -> None:
    """Refuse arrays and types that the runtime does not hold."""
    span = variable["declaration"].get("span")
    if variable["value_type"]["dimensions"] or variable["scalar_count"] != 1:
        raise ir.error(span, f"{variable['name']} is an array; only scalars are supported")
    if variable["value_type"]["scalar"] not in FMI_TYPE:
        kind = variable["value_type"]["scalar"]
        raise ir.error(span, f"{variable['name']} has the type {kind}, which is not supported")


def _literal(ir: Ir, expression: int | None) -> float | None:
    """The number of a literal expression, None for anything else."""
    if expression is None:
        return None
    operation = ir.dae["expressions"][expression]["operation"]
    if operation["kind"] != "literal":
        return None
    ((_, value),) = operation["value"].items()
    return float(value)


def _start(ir: Ir, variable: Mapping[str, Any]) -> float:
    """Start value of one scalar; 0 where the model gives none."""
    given = [name for name in ("binding", "start") if variable["attributes"][name] is not None]
    for name in given:
        value = _number(ir, variable, name)
        if value is not None:
            return value
    if given:
        span = variable["declaration"].get("span")
        raise ir.error(span, f"the start value of {variable['name']} is not a number")
    return 0.0


def _number(ir: Ir, variable: Mapping[str, Any], name: str) -> float | None:
    """An attribute as the compiler evaluated it, None where the model gives none."""
    attributes = variable["attributes"]
    values = attributes[f"{name}_values"]
    return _literal(ir, attributes[name]) if values is None else float(values[0])


def _refuse_moving(ir: Ir, variable: Mapping[str, Any], name: str) -> None:
    """Refuse an attribute that follows a parameter: it would rest at the default's value."""
    expression = variable["attributes"][name]
    if expression is not None:
        found = ir.dae["expressions"][expression]
        if found["variability"] != "constant":
            span = found["provenance"].get("span")
            message = f"{name} of {variable['name']} must not depend on a parameter"
            raise ir.error(span, message)


def start_vectors(ir: Ir, system: System) -> tuple[list[float], list[float]]:
    """Start values of y and p. Slots without a name (previous values, memory) start at 0."""
    vectors = {"y": [0.0] * system.y_count, "p": [0.0] * system.p_count}
    bindings = ir.solve["layout"]["bindings"]
    follows = {(a.vector, a.index) for a in system.initial}
    for variable in ir.dae["variables"]:
        if variable["name"] in bindings:
            ((vector, where),) = bindings[variable["name"]].items()
            if (vector.lower(), where["index"]) not in follows:
                _refuse_moving(ir, variable, "start")
            vectors[vector.lower()][where["index"]] = _start(ir, variable)
    for slot, vector, index in system.previous:
        vectors["p"][slot] = vectors[vector][index]
    return vectors["y"], vectors["p"]


def read_variables(ir: Ir, system: System) -> list[Variable]:
    """Every variable that the FMU shows, in the order of declaration.

    A parameter with a plain number can be set, that of a component by its structured name
    (`stop.stiffness`); one that is bound to others is calculated; a final one with a number never
    changes. Constants are left out.
    Raises BuildError for arrays, unknown types, and units that `units.csv` does not hold.
    """
    bindings = ir.solve["layout"]["bindings"]
    computed = {a.index for a in system.initial if a.vector == "p"}
    units = read_units()
    variables: list[Variable] = []
    for variable in ir.dae["variables"]:
        _single(ir, variable)
        name, role = variable["name"], variable["role"]
        if role == "constant" or name not in bindings:
            continue
        ((vector, where),) = bindings[name].items()
        found = _variable(
            ir, variable, len(variables) + 1, (vector.lower(), where["index"]), computed
        )
        if found.unit is not None and found.unit not in units:
            raise ir.error(variable["declaration"].get("span"), f"unit {found.unit} is not known")
        variables.append(found)
    return variables


def _variable(
    ir: Ir,
    variable: Mapping[str, Any],
    reference: int,
    slot: tuple[str, int],
    computed: set[int],
) -> Variable:
    """One variable with its FMI words."""
    attributes, role = variable["attributes"], variable["role"]
    kind = FMI_TYPE[variable["value_type"]["scalar"]]
    variability = "continuous" if kind == "Float64" else "discrete"
    start: float | None = None
    if role == "parameter":
        follows = slot[1] in computed
        causality, variability = "calculatedParameter" if follows else "parameter", "fixed"
        start = None if follows else _start(ir, variable)
        if not follows and not attributes["tunable"]:  # final
            causality, variability = "local", "constant"
    elif role == "input":
        causality, start = "input", _start(ir, variable)
    else:
        causality = "output" if attributes["causality"] == "output" else "local"
        if role in ("discrete_real", "discrete_value"):
            variability = "discrete"
    if kind == "Float64" and causality != "local":
        _refuse_moving(ir, variable, "minimum")
        _refuse_moving(ir, variable, "maximum")
    return Variable(
        reference=reference,
        name=variable["name"],
        type=kind,
        causality=causality,
        variability=variability,
        start=start,
        unit=attributes["unit"],
        minimum=_number(ir, variable, "minimum"),
        maximum=_number(ir, variable, "maximum"),
        description=attributes["description"] or "",
        vector=slot[0],
        index=slot[1],
    )
