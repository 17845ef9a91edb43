"""Unit expressions against the SI brochure, written down by hand."""

import math

import pytest

from axisrig.fmus.writing.units import BASE, UnitError, read_unit

# text: factor to SI base units, exponents of them (those that are not 0)
KNOWN = {
    "1": (1.0, {}),
    "%": (0.01, {}),
    "m": (1.0, {"m": 1}),
    "mm": (1e-3, {"m": 1}),
    "um": (1e-6, {"m": 1}),
    "kg": (1.0, {"kg": 1}),
    "g": (1e-3, {"kg": 1}),
    "mg": (1e-6, {"kg": 1}),
    "kg.m2": (1.0, {"kg": 1, "m": 2}),
    "m/s": (1.0, {"m": 1, "s": -1}),
    "m.s-1": (1.0, {"m": 1, "s": -1}),
    "mm/min": (1e-3 / 60, {"m": 1, "s": -1}),
    "m/s2": (1.0, {"m": 1, "s": -2}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "N/um": (1e6, {"kg": 1, "s": -2}),
    "N.m/rad": (1.0, {"kg": 1, "m": 2, "s": -2, "rad": -1}),
    "N.s/m": (1.0, {"kg": 1, "s": -1}),
    "kg/(m.s2)": (1.0, {"kg": 1, "m": -1, "s": -2}),
    "W/(m.K)": (1.0, {"kg": 1, "m": 1, "s": -3, "K": -1}),
    "kHz": (1e3, {"s": -1}),
    "1/s": (1.0, {"s": -1}),
    "V.s": (1.0, {"kg": 1, "m": 2, "s": -2, "A": -1}),
    "mOhm": (1e-3, {"kg": 1, "m": 2, "s": -3, "A": -2}),
    "deg": (math.pi / 180, {"rad": 1}),
    "rev/min": (2 * math.pi / 60, {"rad": 1, "s": -1}),
    "rpm": (2 * math.pi / 60, {"rad": 1, "s": -1}),
    "bar": (1e5, {"kg": 1, "m": -1, "s": -2}),
    "min": (60.0, {"s": 1}),
    "kW.h": (3.6e6, {"kg": 1, "m": 2, "s": -2}),
    "cd": (1.0, {"cd": 1}),
    "Pa": (1.0, {"kg": 1, "m": -1, "s": -2}),
}


@pytest.mark.parametrize("text", KNOWN)
def test_factor_and_exponents_of_a_unit(text):
    factor, exponents = KNOWN[text]
    unit = read_unit(text)
    assert unit.factor == pytest.approx(factor, rel=1e-15)
    assert dict(zip(BASE, unit.exponents, strict=True)) == dict.fromkeys(BASE, 0) | exponents
    assert unit.offset == 0.0


def test_degree_celsius_has_an_offset():
    assert (read_unit("degC").factor, read_unit("degC").offset) == (1.0, 273.15)


@pytest.mark.parametrize(
    ("text", "exponents"),
    [("m/degC", {"m": 1, "K": -1}), ("degC2", {"K": 2}), ("degC-1", {"K": -1}),
     ("1/degC", {"K": -1}), ("degC.s", {"K": 1, "s": 1}), ("1/degC2", {"K": -2})],
)  # fmt: skip
def test_degree_celsius_loses_its_offset_in_products_and_powers(text, exponents):
    unit = read_unit(text)
    assert (unit.factor, unit.offset) == (1.0, 0.0)
    assert dict(zip(BASE, unit.exponents, strict=True)) == dict.fromkeys(BASE, 0) | exponents


@pytest.mark.parametrize(
    "text",
    [
        "furlong",
        "",
        "m//s",
        "m.",
        "2m",
        "kmin",
        "m^2",
        "N m",
        "(m.s2",
        "m.s2)",
        "(m.s",
        "()",
        "N/(m.s",
        "N/m.s)",
    ],
)
def test_what_is_no_unit_is_refused(text):
    with pytest.raises(UnitError):
        read_unit(text)
