"""`axisrig oracles`: every closed form with formula and origin."""

import importlib
import inspect
import re

import pytest

from axisrig.bench.tools.listings.oracles import oracle_listing, oracles
from axisrig.kernel.errors import UserError


def test_every_public_function_is_listed_with_its_docstring() -> None:
    found = oracles()
    places = dict.fromkeys(oracle.place for oracle in found)
    for place in places:
        module = importlib.import_module(f"axisrig.bench.oracles.{place}")
        public = {
            name: inspect.getdoc(value)
            for name, value in vars(module).items()
            if inspect.isfunction(value)
            and value.__module__ == module.__name__
            and not name.startswith("_")
        }
        assert {one.name: one.text for one in found if one.place == place} == public


def test_every_closed_form_says_where_it_comes_from() -> None:
    assert [f"{one.place}.{one.name}" for one in oracles() if not one.origin] == []


def test_an_origin_is_that_of_the_form_itself_before_that_of_its_module() -> None:
    """What is after `Source:`, `Derivation:` or `Definition:`; of a module also all of its text."""
    own, of_module = 0, 0
    for one in oracles():
        words = " ".join(one.text.split())
        if re.search(r"\b(Source|Derivation|Definition)s?:", words):
            assert one.origin in words, one.name
            own += 1
        else:
            module = importlib.import_module(f"axisrig.bench.oracles.{one.place}")
            assert one.origin in " ".join((module.__doc__ or "").split()), one.name
            of_module += 1
    assert min(own, of_module) > 5


def test_a_word_shows_what_fits_whole() -> None:
    assert "v T/kp" in oracle_listing("ramp_error_mm")
    assert "Derivation: the offset has to grow by v T" in oracle_listing("ramp_error_mm")
    assert "distance.limits.braking_mm" in oracle_listing("v^2/2a")
    assert "P-AXIS-00414" in oracle_listing("braking_mm")
    assert len(oracle_listing().splitlines()) > len(oracles())
    assert "supervision.first_due" in oracle_listing("p-axis-00414")  # in the source of its module
    for word in ("RAMP_error_mm", "V^2/2A", "v T/kp"):
        assert oracle_listing(word) == oracle_listing(word.upper()) == oracle_listing(word.lower())
    with pytest.raises(UserError, match="no closed form has this word"):
        oracle_listing("nothing of this kind")
