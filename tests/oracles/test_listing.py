"""`axisrig oracles`: every closed form with formula and origin."""

import importlib
import inspect
import re

import pytest

from axisrig.bench.tools.listings import oracles as closed_forms
from axisrig.bench.tools.listings.oracles import Oracle, oracle_listing, oracles
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


@pytest.mark.long
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


OWN = [
    Oracle("stop", "way_mm", "v t.\n\nMore of it.", "ISO 1"),
    Oracle("stop", "time_s", "v over a, in\ntwo lines.", "ISO 1"),
    Oracle("stop", "way", "Way alone.", "ISO 2"),
    Oracle("stop.late", "way_mm", "Late. ISO 3 has it.", "ISO 3"),
]


@pytest.mark.interpreted
def test_each_module_has_its_forms_and_each_origin_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A module below a folder of the same name has its own part."""
    monkeypatch.setattr(closed_forms, "oracles", lambda: OWN)
    assert oracle_listing().splitlines()[1:] == [
        "", "stop",
        f"  {'way_mm':<28} v t.", f"  {'time_s':<28} v over a, in two lines.",
        f"  {'way':<28} Way alone.", "  ISO 1", "  ISO 2",
        "", "stop.late", f"  {'way_mm':<28} Late. ISO 3 has it.", "  ISO 3",
    ]  # fmt: skip


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("word", "shown"),
    [
        ("way", ["stop.way"]),  # by its whole name, though others have it in theirs
        ("WAY_mm", ["stop.way_mm", "stop.late.way_mm"]),
        ("stop.way_mm", ["stop.way_mm"]),
        ("Stop.Way", ["stop.way"]),  # with its module; that of way_mm begins so too
        ("stop.late", ["stop.late.way_mm"]),
        ("late", ["stop.late.way_mm"]),
        ("iso 1", ["stop.way_mm", "stop.time_s"]),
        ("more of", ["stop.way_mm"]),
    ],
)
def test_a_name_comes_before_words_in_texts(
    word: str, shown: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(closed_forms, "oracles", lambda: OWN)
    blocks = oracle_listing(word).split("\n\nstop.")
    assert [block.splitlines()[0].removeprefix("stop.") for block in blocks] == [
        name.removeprefix("stop.") for name in shown
    ]


@pytest.mark.interpreted
def test_a_wrong_name_of_a_form_has_near_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closed_forms, "oracles", lambda: OWN)
    with pytest.raises(UserError, match="no closed form has this word") as caught:
        oracle_listing("tmie_s")
    assert (caught.value.value, str(caught.value.allowed)) == ("tmie_s", "time_s")


MODULE = '''"""About the module.

Sources: ISO 9, 4,
and more."""
def first():
    """First.

    Derivation: F = m a,
    of Newton.

    More of it.
    """
def second():
    """Second. Definition: as ISO 2."""
def third():
    """Third, without."""
def _own():
    """None of it. Source: nobody."""
class Kept:
    """Source: no function."""
    def way(self):
        """A method."""
def fourth(): pass
'''


@pytest.mark.interpreted
def test_an_origin_is_the_paragraph_that_begins_with_its_word(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sources = [("own", MODULE), ("plain", '"""All\nof it."""\ndef way():\n    """Way."""\n')]
    monkeypatch.setattr(closed_forms, "_modules", lambda *_: sources)
    assert [(one.place, one.name, one.origin) for one in oracles()] == [
        ("own", "first", "Derivation: F = m a, of Newton."),
        ("own", "second", "Definition: as ISO 2."),
        ("own", "third", "Sources: ISO 9, 4, and more."),
        ("own", "fourth", "Sources: ISO 9, 4, and more."),
        ("plain", "way", "All of it."),
    ]
