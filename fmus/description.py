"""Writes the model description of one FMU."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import jinja2

from fmus.ir import TARGET, Ir
from fmus.variables import Variable, read_units

TOKEN_MARK = "@TOKEN@"  # stands for the instantiation token until the texts are complete


def identifier_of(model: str) -> str:
    """The modelIdentifier of a model: its full name as a C identifier."""
    return re.sub(r"\W", "_", model)


def templates(**filters: Callable[[str], str]) -> jinja2.Environment:
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


def describe(ir: Ir, variables: Sequence[Variable], step_s: float) -> str:
    """The text of modelDescription.xml, with `TOKEN_MARK` in place of the token."""
    used = {variable.unit for variable in variables if variable.unit} | {"s"}
    units = [row for unit, row in read_units().items() if unit in used]
    return (
        templates()
        .get_template("modelDescription.xml.jinja")
        .render(
            model=ir.model,
            identifier=identifier_of(ir.model),
            text=_class_text(ir),
            step=repr(step_s),
            units=units,
            exponents=("kg", "m", "s", "A", "rad"),
            variables=variables,
            outputs=[v for v in variables if v.causality == "output"],
            unknowns=[v for v in variables if v.causality in ("output", "calculatedParameter")],
            number=_number,
        )
    )


def _number(variable: Variable, value: float) -> str:
    """A value as XML text of the type of its variable."""
    if variable.type == "Float64":
        return repr(value)
    if variable.type == "Int32":
        return str(int(value))
    return "true" if value else "false"


def _class_text(ir: Ir) -> str:
    """The description string of the model's class."""
    name = ir.model.split(".")[-1]
    pattern = re.compile(rf'\b(?:model|block)\s+{name}\s+"((?:[^"\\]|\\.)*)"')
    for path, text in ir.files.values():
        found = pattern.search(text)
        if found and Path(path).stem in (name, "package"):
            return found.group(1)
    return ""
