"""Writes the model description of one FMU."""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jinja2
from markupsafe import Markup

from axisrig.fmus.equations.system import System
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.target import TARGET
from axisrig.fmus.writing.early import early_levels
from axisrig.fmus.writing.structure import output_dependencies
from axisrig.fmus.writing.units import BASE, Unit, read_unit
from axisrig.fmus.writing.variables import Variable

TOKEN_MARK = "@TOKEN@"  # placeholder of the instantiation token until the texts are complete
FMI2_TYPES: Mapping[str, str] = {
    "Float64": "Real",
    "Int32": "Integer",
    "Boolean": "Boolean",
    "Enumeration": "Enumeration",
}
# Modelica's words for the experiment and those of FMI.
_EXPERIMENT: Mapping[str, str] = {
    "StartTime": "startTime",
    "StopTime": "stopTime",
    "Tolerance": "tolerance",
    "Interval": "stepSize",
}
_NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"


def identifier_of(model: str) -> str:
    """The modelIdentifier of a model: its full name as a C identifier."""
    return re.sub(r"\W", "_", model)


def templates(**filters: Callable[..., str]) -> jinja2.Environment:
    """The templates of the target folder; XML ones escape what they insert."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TARGET),
        undefined=jinja2.StrictUndefined,
        autoescape=lambda name: bool(name and name.endswith(".xml.jinja")),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(filters)
    return environment


def describe(ir: Ir, system: System, variables: Sequence[Variable], step_s: float, fmi: str) -> str:
    """The text of modelDescription.xml, with `TOKEN_MARK` in place of the token.

    variables: for version 2.0 without arrays.
    """
    # The time comes first, then the variables in the order of their references.
    used = {variable.unit for variable in variables if variable.unit} | {"s"}
    types = {v.enumeration: v.literals for v in variables if v.literals}
    return (
        templates(
            base_unit=_base_unit,
            attributes=_attributes,
            value_attributes=_value_attributes,
            dependencies=_dependencies,
        )
        .get_template(f"modelDescription{fmi[0]}.xml.jinja")
        .render(
            model=ir.model,
            identifier=identifier_of(ir.model),
            text=" ".join((ir.flat["model_description"] or "").split()),
            step=repr(step_s),
            units=[(name, read_unit(name)) for name in sorted(used)],
            types=sorted(types.items()),
            experiment=_experiment(ir),
            variables=variables,
            outputs=[v for v in variables if v.causality == "output"],
            early=early_levels(ir, variables),
            unknowns=[v for v in variables if _is_initial_unknown(v)],
            depends=output_dependencies(system, variables),
            fmi2_types=FMI2_TYPES,
        )
    )


def _is_initial_unknown(variable: Variable) -> bool:
    return variable.causality in ("output", "calculatedParameter") and (
        variable.initial == "calculated"
    )


def _attributes(pairs: Mapping[str, str]) -> str:
    """XML attributes, each with a space before it."""
    return Markup("").join(Markup(' {}="{}"').format(*pair) for pair in pairs.items())


def _base_unit(unit: Unit) -> str:
    """Exponents that are not 0, factor and offset where they are not the default."""
    pairs = {name: str(n) for name, n in zip(BASE, unit.exponents, strict=True) if n}
    pairs |= {"factor": repr(unit.factor)} if unit.factor != 1.0 else {}
    pairs |= {"offset": repr(unit.offset)} if unit.offset != 0.0 else {}
    return _attributes(pairs)


def _value_attributes(variable: Variable) -> str:
    """The attributes that a type of value has: they are the same words in both versions."""
    pairs = {"declaredType": variable.enumeration} if variable.literals else {}
    pairs |= {"unit": variable.unit} if variable.unit else {}
    if variable.type != "Boolean" and not variable.literals:
        limits = {"min": variable.minimum, "max": variable.maximum, "nominal": variable.nominal}
        allowed = limits if variable.type == "Float64" else ("min", "max")
        pairs |= {
            name: _number(variable, value)
            for name, value in limits.items()
            if value is not None and name in allowed
        }
    if variable.start is not None:
        pairs["start"] = " ".join(_number(variable, value) for value in variable.start)
    return _attributes(pairs)


def _number(variable: Variable, value: float) -> str:
    """A value as XML text of the type of its variable."""
    if variable.type == "Float64":
        return repr(value)
    if variable.type == "Boolean":
        return "true" if value else "false"
    return str(int(value))


def _dependencies(references: tuple[int, ...] | None, offset: int = 0) -> str:
    """The attribute `dependencies`, none when they are not known."""
    if references is None:
        return ""
    return _attributes({"dependencies": " ".join(str(r + offset) for r in references)})


def _experiment(ir: Ir) -> dict[str, str]:
    """Start, stop, tolerance and step of the model's annotation experiment(), or of a second."""
    found: dict[str, Any] = {"startTime": 0.0, "stopTime": 1.0, "stepSize": 1e-3}
    text = re.search(r"\bexperiment\s*\(([^()]*)\)", _class_body(ir))
    for word, name in _EXPERIMENT.items():
        value = text and re.search(rf"\b{word}\s*=\s*({_NUMBER})", text.group(1))
        if value:
            found[name] = float(value.group(1))
    if found["stopTime"] <= found["startTime"]:
        found["stopTime"] = found["startTime"] + 1.0
    return {name: repr(value) for name, value in found.items()}


def _class_body(ir: Ir) -> str:
    """The text of the model's class, empty when no file has it."""
    name = re.escape(ir.model.split(".")[-1])
    body = re.compile(rf"\b(?:model|block|class)\s+{name}\b.*?\bend\s+{name}\s*;", re.DOTALL)
    for path, text in ir.files.values():
        found = body.search(text)
        if found and path.stem in (*ir.model.split("."), "package"):
            return found.group(0)
    return ""
