"""The examples of `axisrig language WORD`: each is a program that is read, and has a page."""

import re
from pathlib import Path

import pytest

from axisrig.bench.tools.listings.language import language_listing, page
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.words import commands, examples, words

ROOT = Path(__file__).parents[3]
TEXTS = {text: (word, place) for word, (text, place) in examples().items()}


@pytest.mark.parametrize("text", TEXTS, ids=[word for word, _ in TEXTS.values()])
def test_an_example_is_a_program_without_errors(text):
    checked = check_program(text + "\n", Path("example.nc"), ("X", "Y", "Z"))
    assert [str(error) for error in checked.errors] == []


@pytest.mark.parametrize("place", sorted({place for _, place in TEXTS.values()}))
def test_the_page_of_an_example_has_the_section(place):
    path, _, anchor = place.partition("#")
    lines = (ROOT / path).read_text(encoding="utf-8").splitlines()
    titles = [line.lstrip("#").strip().lower() for line in lines if line.startswith("#")]
    anchors = {re.sub(r"[^a-z0-9 -]", "", title).replace(" ", "-") for title in titles}
    assert anchor in {"", *anchors}


def test_an_example_stands_beside_a_word_that_exists_and_uses_it():
    known = {word for kind in ("G", "M", "address", "control") for word in words(kind)}
    known |= {
        f"<axis>[{name[6:]}]" if name.startswith("<axis>") else f"#{name}" for name in commands()
    }
    assert examples().keys() - known == set()


def test_every_g_function_and_control_structure_that_acts_has_an_example():
    wanted = {w.word for kind in ("G", "control") for w in words(kind).values() if w.acts}
    assert wanted - examples().keys() == {"G40", "G61", "G260", "G261"}


def test_a_word_is_told_with_its_example_and_its_page_once():
    message = language_listing("G4")
    assert message.count("    example: N10 G4 1.5") == 1
    assert message.endswith("    see docs/motion.md#dwell-time")
    assert "$FOR P1 = 1, 5, 1" in language_listing("$FOR")
    assert "| `$FOR` `$ENDFOR` | `$FOR P1 = 1, 5, 1`<br>" in page()
