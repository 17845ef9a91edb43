"""Writes the model description of one FMU."""

import importlib.metadata
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jinja2
from markupsafe import Markup

from axisrig.fmus.equations.system import System
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.target import TARGET
from axisrig.fmus.reading.texts import Class, Texts
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
# The tolerance is that of the integration (solver.inc); the step is the usual cycle of a fieldbus.
_DEFAULT_EXPERIMENT = {"startTime": 0.0, "stopTime": 1.0, "tolerance": 1e-9, "stepSize": 1e-3}
OWN_LIBRARY = "AxisRig"
LICENSE, AUTHOR, COPYRIGHT = "Apache-2.0", "axisrig", "Copyright the authors of axisrig"
_NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"


def identifier_of(model: str) -> str:
    """The modelIdentifier of a model: its full name as a C identifier."""
    return re.sub(r"\W", "_", model)


def templates(**filters: Callable[..., str]) -> jinja2.Environment:
    """The templates of the target folder; XML and HTML ones escape what they insert."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TARGET),
        undefined=jinja2.StrictUndefined,
        autoescape=lambda name: bool(name and name.endswith((".xml.jinja", ".html.jinja"))),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(filters)
    return environment


def describe(
    ir: Ir,
    texts: Texts,
    system: System,
    variables: Sequence[Variable],
    step_s: float,
    fmi: str,
) -> str:
    """The text of modelDescription.xml, with `TOKEN_MARK` in place of the token.

    variables: for version 2.0 without arrays. step_s: longest internal step of the integration, s.
    """
    # The time comes first, then the variables in the order of their references.
    shown = _display_units(texts, variables)
    used = {variable.unit for variable in variables if variable.unit} | {"s"}
    types = {v.enumeration: v.literals for v in variables if v.literals}
    return (
        templates(
            base_unit=_base_unit,
            display_unit=_display_unit,
            attributes=_attributes,
            value_attributes=_value_attributes,
            dependencies=_dependencies,
        )
        .get_template(f"modelDescription{fmi[0]}.xml.jinja")
        .render(
            model=ir.model,
            identifier=identifier_of(ir.model),
            head=head_of(ir, texts),
            step=repr(step_s),
            units=[(name, read_unit(name), shown.get(name, [])) for name in sorted(used)],
            types=sorted(types.items()),
            real_types=[
                (name, _type_attributes(texts, name))
                for name in sorted({v.declared for v in variables if v.declared})
            ],
            experiment=_experiment(texts.get(ir.model)),
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


def _attributes(pairs: Mapping[str, str], before: str = " ") -> str:
    """XML attributes, each with `before` before it."""
    return Markup("").join(Markup('{}{}="{}"').format(before, *pair) for pair in pairs.items())


def _base_unit(unit: Unit) -> str:
    """Exponents that are not 0, factor and offset where they are not the default."""
    pairs = {name: str(n) for name, n in zip(BASE, unit.exponents, strict=True) if n}
    pairs |= {"factor": repr(unit.factor)} if unit.factor != 1.0 else {}
    pairs |= {"offset": repr(unit.offset)} if unit.offset != 0.0 else {}
    return _attributes(pairs)


def _value_attributes(variable: Variable) -> str:
    """The attributes that a type of value has: they are the same words in both versions."""
    declared = variable.enumeration if variable.literals else variable.declared
    pairs = {"declaredType": declared} if declared else {}
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


def _dependencies(references: tuple[int, ...] | None) -> str:
    """The attribute `dependencies`, none when they are not known."""
    if references is None:
        return ""
    return _attributes({"dependencies": " ".join(map(str, references))})


def _experiment(model: Class | None) -> dict[str, str]:
    """Start, stop, tolerance and step of the model's annotation experiment(), else the default."""
    found: dict[str, Any] = dict(_DEFAULT_EXPERIMENT)
    text = model.annotation("experiment") if model is not None else ""
    for word, name in _EXPERIMENT.items():
        value = re.search(rf"\b{word}\s*=\s*({_NUMBER})", text)
        if value:
            found[name] = float(value.group(1))
    if found["stopTime"] <= found["startTime"]:
        found["stopTime"] = found["startTime"] + 1.0
    return {name: repr(value) for name, value in found.items()}


def head_of(ir: Ir, texts: Texts) -> dict[str, str]:
    """What the root element says about the model: words that both versions have.

    Author, copyright and license are those of the library of axisrig; of another library nothing is
    known but its version.
    """
    library = ir.model.partition(".")[0]
    version = _version(texts.get(library))
    found = {"description": " ".join((ir.flat["model_description"] or "").split())}
    if library == OWN_LIBRARY:
        version = version or importlib.metadata.version("axisrig")
        found |= {"author": AUTHOR, "copyright": COPYRIGHT, "license": LICENSE}
    return found | ({"version": version} if version else {})


def _version(library: Class | None) -> str:
    """The annotation version of a library."""
    found = library and re.search(r'\bversion\s*=\s*"([^"]*)"', library.text)
    return found.group(1) if found else ""


def _display_units(texts: Texts, variables: Sequence[Variable]) -> dict[str, list[str]]:
    """The units in which the types want values of a unit to be shown."""
    found: dict[str, set[str]] = {}
    for name in {variable.declared for variable in variables if variable.declared}:
        attributes = _type_attributes(texts, name)
        if "displayUnit" in attributes:
            found.setdefault(attributes["unit"], set()).add(attributes["displayUnit"])
    return {unit: sorted(shown) for unit, shown in found.items()}


def _type_attributes(texts: Texts, name: str) -> dict[str, str]:
    """Attributes of a type: quantity, unit, displayUnit and nominal, as far as it has them."""
    declared = texts.get(name)
    found = texts.attributes(declared) if declared is not None else {}
    if "nominal" in found:
        found["nominal"] = repr(abs(float(found["nominal"])))
    return found


def _display_unit(name: str, unit: Unit) -> str:
    """Attributes of a unit to show: value shown = factor*value + offset."""
    shown = read_unit(name)
    pairs = {"name": name, "factor": repr(unit.factor / shown.factor)}
    offset = (unit.offset - shown.offset) / shown.factor
    return _attributes(pairs | ({"offset": repr(offset)} if offset else {}))
