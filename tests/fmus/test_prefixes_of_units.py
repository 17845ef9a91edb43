"""Prefixes and powers in unit expressions, against the SI brochure (9th edition, table 7)."""

import pytest

from axisrig.fmus.writing.units import BASE, PREFIXES, UnitError, read_unit

POWERS = {
    "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "d": -1, "c": -2, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
}  # fmt: skip


def exponents(text: str) -> dict[str, int]:
    """Those of the base units that are not 0."""
    found = read_unit(text).exponents
    return {name: power for name, power in zip(BASE, found, strict=True) if power}


@pytest.mark.parametrize(("symbol", "tens"), [("m", 0), ("s", 0), ("g", -3), ("V", 0), ("Pa", 0)])
def test_a_prefix_is_its_power_of_ten(symbol: str, tens: int) -> None:
    """Of the gram too, though the base unit is the kilogram."""
    assert set(PREFIXES) == set(POWERS)
    for prefix, power in POWERS.items():
        found = read_unit(f"{prefix}{symbol}")
        assert found.factor == pytest.approx(float(f"1e{power + tens}"), rel=1e-15)
        assert (found.offset, exponents(f"{prefix}{symbol}")) == (0.0, exponents(symbol))


@pytest.mark.parametrize(
    ("text", "factor", "powers"),
    [
        # Symbols that could be a prefix and another one
        ("cd", 1.0, {"cd": 1}), ("Pa", 1.0, {"kg": 1, "m": -1, "s": -2}), ("min", 60.0, {"s": 1}),
        ("mol", 1.0, {"mol": 1}), ("T", 1.0, {"kg": 1, "s": -2, "A": -1}), ("h", 3600.0, {"s": 1}),
        ("d", 86400.0, {"s": 1}), ("mT", 1e-3, {"kg": 1, "s": -2, "A": -1}),
        ("mmol", 1e-3, {"mol": 1}), ("dam", 10.0, {"m": 1}), ("dm", 0.1, {"m": 1}),
        ("hPa", 100.0, {"kg": 1, "m": -1, "s": -2}), ("daN", 10.0, {"kg": 1, "m": 1, "s": -2}),
        # A power is of the unit with its prefix
        ("mm2", 1e-6, {"m": 2}), ("mm3", 1e-9, {"m": 3}), ("km2", 1e6, {"m": 2}),
        ("mm-1", 1e3, {"m": -1}), ("1/mm2", 1e6, {"m": -2}), ("ms-2", 1e6, {"s": -2}),
        ("g2", 1e-6, {"kg": 2}), ("kg2", 1.0, {"kg": 2}), ("1/g", 1e3, {"kg": -1}),
        ("mg-1", 1e6, {"kg": -1}), ("m+2", 1.0, {"m": 2}), ("min-1", 1 / 60, {"s": -1}),
        ("%2", 1e-4, {}), ("1/%", 100.0, {}), ("mm/mm", 1.0, {}), ("um/mm", 1e-3, {}),
        # More than one division, and parentheses on either side
        ("m/s/s", 1.0, {"m": 1, "s": -2}), ("mm/ms/us", 1e6, {"m": 1, "s": -2}),
        ("m/(s.A)", 1.0, {"m": 1, "s": -1, "A": -1}), ("m/s.A", 1.0, {"m": 1, "s": -1, "A": -1}),
        ("(kg.m)/(s2.A)", 1.0, {"kg": 1, "m": 1, "s": -2, "A": -1}),
        ("N/(mm.um)", 1e9, {"kg": 1, "m": -1, "s": -2}),
        (" m / s ", 1.0, {"m": 1, "s": -1}), ("kg . m2", 1.0, {"kg": 1, "m": 2}),
    ],
)  # fmt: skip
def test_symbols_powers_and_divisions(text: str, factor: float, powers: dict[str, int]) -> None:
    assert read_unit(text).factor == pytest.approx(factor, rel=1e-14)
    assert exponents(text) == powers


@pytest.mark.parametrize(
    "text",
    ["k", "mk", "kkm", "dakm", "mdeg", "krpm", "kh", "md", "k%", "m%", "ksr", "mdegC", "M", "1m",
     "xm", "dag.", ".m", "/", "m/", "(m", "m)", "m.(s", "m 2", "m2.5", "m--2", "K.furlong"],
)  # fmt: skip
def test_what_takes_no_prefix_or_is_no_product_is_refused(text: str) -> None:
    """A prefix alone, two of them, and one before a unit that takes none."""
    with pytest.raises(UnitError):
        read_unit(text)
