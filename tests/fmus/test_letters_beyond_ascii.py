"""Places after letters of several bytes: the compiler counts bytes, a text its letters.

Nothing is compiled. Before each place are more such letters than a line is long, so that who mixes
the two up names another line.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.modified import refuse_unknown_modifiers
from axisrig.fmus.reading.modifiers import refuse_dropped_modifiers, shared_numbers
from axisrig.fmus.reading.support import refuse_unsupported
from axisrig.fmus.reading.texts import Texts

ROOT = Path("/models")
# One to four bytes in UTF-8
LETTERS = pytest.mark.parametrize("letter", ["a", "\u00e4", "\u8ef8", "\U0001d6c3"])
PLACES = pytest.mark.parametrize("place", ["above", "title", "beside"])


def text_of(line: str, letter: str, place: str, name: str = "M") -> str:
    """A model whose line 5 it is, with many letters above, in its title or in the line itself."""
    many = letter * 60
    above, title, beside = (many if place == word else "" for word in ("above", "title", "beside"))
    return (
        f'// {above}\nmodel {name} "{title}"\n  // a note\n  Real z;\n  /* {beside} */ {line}\n'
        f"  Real y;\nend {name};\n"
    )


def read(*texts: str, flat: Mapping[str, Any] | None = None, **words: Any) -> Ir:
    """A model M in the first of these texts; words: uses of what is not supported."""
    files = {n: (ROOT / f"F{n}.mo", text) for n, text in enumerate(texts, 1)}
    solve = {
        "solve_layout": {"pre_param_bindings": [], "terminal_event_parameter_index": None},
        "events": {"scheduled_root_conditions": []},
        "discrete": {
            "rhs_plan": {"programs": []}, "guarded_assignment_plan": {"programs": []},
            "update_targets": [], "observation_refresh": [],
        },
        "artifacts": {"continuous": {"mass_matrix": {"kind": "identity"}}},
        "layout": {"bindings": {}},
    }  # fmt: skip
    temporal = {"delays": [], "terminals": [], "previous": [], **words}
    dae = {"systems": {"temporal": temporal}}
    return Ir("M", solve, dae, flat or {"variables": {}}, files, ROOT)


# Words that are not supported

WORDS = pytest.mark.parametrize(
    ("kind", "word"),
    [("delays", "delay"), ("terminals", "terminal"), ("previous", "previous")],
)


@LETTERS
@PLACES
@WORDS
def test_a_word_that_is_not_supported(letter: str, place: str, kind: str, word: str) -> None:
    text = text_of(f"Real x = {word}(z);", letter, place)
    with pytest.raises(BuildError) as caught:
        refuse_unsupported(read(text, **{kind: [1]}))
    assert str(caught.value) == f"F1.mo:5: {word}() is not supported"


@WORDS
@pytest.mark.parametrize(
    "line",
    [
        'Real x = f("{}(z)");', "// {}(z)", "/* {}(z) */", "Real x = my_{}(z);", "Real x = {}s(z);",
        "Real {};", "Real x = {}[1];",
    ],
)  # fmt: skip
def test_a_word_that_is_no_call_of_it_is_not_where_it_is(line: str, kind: str, word: str) -> None:
    """In a text or a note, as a part of another name, or the name of a variable."""
    text = text_of(line.format(word), "a", "above")
    with pytest.raises(BuildError, match=rf"^M: {word}\(\) is not supported$"):
        refuse_unsupported(read(text, **{kind: [1]}))


@WORDS
def test_a_word_is_where_the_model_uses_it(kind: str, word: str) -> None:
    """In a class that it reaches, in the file of this class; the model itself comes first."""
    call, many = f"Real x = {word}  (z);", "\u00e4"
    bad, good = text_of(call, many, "title", "Bad"), text_of("Real x;", many, "title", "Good")
    for line, place in (("Good g;", "M"), ("Bad b;", "F2.mo:5"), (f"Bad b; {call}", "F1.mo:5")):
        with pytest.raises(BuildError) as caught:
            refuse_unsupported(read(text_of(line, many, "above"), bad, good, **{kind: [1]}))
        assert str(caught.value) == f"{place}: {word}() is not supported"


# Modifiers


@LETTERS
@PLACES
def test_a_modifier_that_the_compiler_drops(letter: str, place: str) -> None:
    line = "Base b(redeclare model P = Part(k = 5));"
    with pytest.raises(BuildError, match="the compiler drops the modifier") as caught:
        refuse_dropped_modifiers(read(text_of(line, letter, place)))
    assert (caught.value.file, caught.value.line) == ("F1.mo", 5)
    used = text_of("Other o;", letter, place), text_of(line, letter, place, "Other")
    with pytest.raises(BuildError) as caught:
        refuse_dropped_modifiers(read(*used))
    assert (caught.value.file, caught.value.line) == ("F2.mo", 5)


@LETTERS
@PLACES
@pytest.mark.parametrize(
    ("line", "wrong", "near"),
    [
        ("Part p(gian = 2);", "gian", "gain"), ("Part p(gain(strat = 2));", "strat", "start"),
        ("extends Part(gian = 2);", "gian", "gain"),
        ("Part o(gain = 1), p(gian = 2);", "gian", "gain"),
    ],
)  # fmt: skip
def test_a_modifier_of_nothing(letter: str, place: str, line: str, wrong: str, near: str) -> None:
    part = text_of("parameter Real gain = 1;", letter, place, "Part")
    names = ("p.gain", "p.x", "o.gain", "gain", "x", "y", "z")
    flat = {"variables": dict.fromkeys(names)}
    for files in ((text_of(line, letter, place), part), (part, text_of(line, letter, place))):
        ir = read(*files, flat=flat)
        with pytest.raises(BuildError, match=f"there is no {wrong} to modify") as caught:
            refuse_unknown_modifiers(ir, Texts(ir))
        file = f"F{files.index(text_of(line, letter, place)) + 1}.mo"
        assert (caught.value.file, caught.value.line) == (file, 5)
        assert caught.value.message.endswith(f"did you mean {near}")


# Numbers that two parameters have from one place


@LETTERS
@pytest.mark.parametrize("is_own", [True, False])
def test_a_number_of_a_declaration_after_a_long_note(letter: str, is_own: bool) -> None:
    """Between it and a declaration of its own there is no semicolon, whatever the note says."""
    end = "" if is_own else ";"
    text = f"// {letter * 60};;\nReal k{end} /* {letter * 9} */ = 5;\n"
    at, own = (len(text[: text.index(word)].encode()) for word in ("5", "Real"))
    span = {"source": 1, "start": at}
    variables = [
        {"name": name, "role": "parameter", "scalar_names": [name], "attributes": {"binding": 0},
         "value_type": {"dimensions": []}, "declaration": {"span": {"source": 1, "start": own}}}
        for name in ("a.k", "a.b.k")
    ]  # fmt: skip
    expression = {"provenance": {"span": span}, "variability": "constant"}
    dae = {"variables": variables, "expressions": [expression]}
    bindings = {"a.k": {"P": {"index": 3}}, "a.b.k": {"P": {"index": 8}}}
    files = {1: (ROOT / "F1.mo", text)}
    ir = Ir("M", {"layout": {"bindings": bindings}}, dae, {}, files, ROOT)
    found = [(own, other, str(place)) for own, other, place in shared_numbers(ir)]
    assert found == ([] if is_own else [(8, 3, "F1.mo:2")])
