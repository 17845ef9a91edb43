"""Modifiers in lists of lists: which names are there, and the line of one that is not."""

from pathlib import Path

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import compile_model
from axisrig.fmus.reading.modified import refuse_unknown_modifiers
from axisrig.fmus.reading.texts import Texts

MODEL = """model M
  model Extra
    parameter Real g = 1;
    Real z;
  equation
    z = g;
  end Extra;
  model First
    parameter Boolean has = false;
    parameter Real a = 1, b = 2;
    Extra always;
    Extra extra if has;
  end First;
  model Second
    extends First;
    parameter Real c = 3;
  end Second;
  model Third
    extends Second;
    Real x;
  equation
    x = a*b*c;
  end Third;
  model Whole
    Third left;
    Third right;
  end Whole;
{use}end M;
"""
HEAD = MODEL.partition("{use}")[0].count("\n")


def look_at(folder: Path, use: str) -> None:
    file = folder / "M.mo"
    file.write_text(MODEL.replace("{use}", use), encoding="utf-8")
    ir = compile_model("M", file)
    refuse_unknown_modifiers(ir, Texts(ir))


USES = (
    "  model Other = {}\n  Other o;\n",
    "  model Other\n    extends {}\n  end Other;\n  Other o;\n",
)
"""As a short class and as a base class."""


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize(
    ("modifiers", "wrong", "near"),
    [
        ("Third(\n a = 3,\n b(\n  start = 1,\n  startt = 2));", "startt", "start"),
        ("Third(a(min = 0),\n b(max = 9),\n c(start = 1,\n\n  maxx = 2));", "maxx", "max"),
        ("Third(a = 3,\n always(g = 2),\n c(unitt = 1));", "unitt", "unit"),
        ("Whole(left(a = 1),\n right(b = 2,\n  always(\n   gg = 3)));", "gg", "g"),
        ("Whole(left(a = 1,\n  b(strat = 2)), right(b = 2));", "strat", "start"),
        ("Third(a = {1, 2}*{3, 4},\n b = max(1, 2),\n cc = 2);", "cc", "c"),
    ],
)  # fmt: skip
def test_a_name_that_is_not_there_has_its_own_line_however_deep_it_is(
    tmp_path: Path, use: str, modifiers: str, wrong: str, near: str
) -> None:
    text = use.format(modifiers)
    with pytest.raises(BuildError) as caught:
        look_at(tmp_path, text)
    line = HEAD + text[: text.index(f"{wrong} =")].count("\n") + 1
    assert (caught.value.file, caught.value.line) == ("M.mo", line)
    assert f"there is no {wrong} to modify" in caught.value.message
    assert f"did you mean {near}" in caught.value.message


@pytest.mark.parametrize(
    "modifiers",
    [
        # Of the class itself, of its base class and of the base class of that
        "Third(c = 4);", "Third(a = 3, b(start = 2) = 4);", "Third(always(g = 2));",
        # What a condition leaves out is there, of whichever class it comes from
        "First(extra(g = 2));", "Second(extra(g = 2));", "Third(a = 2, extra(g = 2));",
        "Third(has = true, extra(g = 2));",
        "Whole(left(extra(g = 2)), right(a = 1, extra(g = 3)));",
    ],
)  # fmt: skip
def test_inherited_names_are_there(tmp_path: Path, modifiers: str) -> None:
    look_at(tmp_path, USES[0].format(modifiers))


@pytest.mark.parametrize("class_name", ["First", "Second", "Third"])
def test_an_inherited_name_that_is_left_out_is_among_the_nearest(
    tmp_path: Path, class_name: str
) -> None:
    with pytest.raises(BuildError, match="there is no extr to modify in") as caught:
        look_at(tmp_path, USES[0].format(f"{class_name}(extr(g = 2));"))
    assert caught.value.message.endswith(f"in {class_name}; did you mean extra")
