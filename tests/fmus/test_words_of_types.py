"""What the text of a library says of its types and of the parts of a model."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_words_of_models import texts

from axisrig.fmus.writing.description import _display_units, _type_attributes


@pytest.mark.parametrize(
    ("nominal", "written"), [("-5", "5.0"), ("5", "5.0"), ("-2e-3", "0.002"), ("0.5", "0.5")]
)
def test_the_nominal_value_of_a_type_is_an_amount(nominal: str, written: str) -> None:
    text = f'type Way = Real(unit = "m", nominal = {nominal});'
    found, _ = texts(text, "Way.mo")
    assert _type_attributes(found, "Way") == {"unit": "m", "nominal": written}
    assert _type_attributes(found, "Other") == {}


def test_units_to_show_are_in_the_order_of_their_names() -> None:
    """Those of each unit apart, each once, and of types that have one alone."""
    names = ("um", "mm", "cm", "km", "nm", "dm")
    lines = [f'type W_{n} = Real(unit = "m", displayUnit = "{n}");' for n in names]
    lines += ['type Again = Real(unit = "m", displayUnit = "mm");', 'type None = Real(unit = "m");',
              'type Turn = Real(unit = "rad", displayUnit = "deg");']  # fmt: skip
    found, _ = texts("\n".join(lines), "Types.mo")
    types = [*(f"W_{n}" for n in names), "Again", "None", "Turn", ""]
    variables: Any = [SimpleNamespace(declared=name) for name in types]
    assert _display_units(found, variables) == {"m": sorted(names), "rad": ["deg"]}


@pytest.mark.parametrize(
    ("keyword", "is_part"), [("model", True), ("block", True), ("record", False)]
)
def test_parts_of_a_model_are_models_and_blocks(keyword: str, is_part: bool) -> None:
    text = f"""
{keyword} Part
  Real y;
end Part;
model Whole
  Part first;
  Part second;
end Whole;
"""
    found, _ = texts(text, "Whole.mo")
    assert [one.name for one in found.used("Whole")] == ["Whole", "Part"][: 1 + is_part]


@pytest.mark.parametrize(
    "info", ["<html>\\n  says <b>x</b>\\n</html>", "says <b>x</b>", "<html>says <b>x</b></html> "]
)
def test_the_documentation_has_no_frame_and_no_blanks_around_it(info: str) -> None:
    text = f'model M annotation(Documentation(info = "{info}")); end M;'.replace("\\n", "\n")
    found, _ = texts(text, "M.mo")
    model = found.get("M")
    assert model is not None
    assert model.documentation() == "says <b>x</b>"
