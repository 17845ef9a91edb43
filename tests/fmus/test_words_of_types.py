"""What a description has of the types of a library: their nominal values, their units to show."""

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
