"""A modifier whose name is not there: its line, its nearest name, and names that are there.

Nothing is compiled: texts of classes, and the variables that the compiler has flattened.
"""

from pathlib import Path

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.modified import ATTRIBUTES, refuse_unknown_modifiers
from axisrig.fmus.reading.texts import Texts

ROOT = Path("/models")
PARTS = """model Part
  parameter Real gain = 1, offset = 0;
  Real y(start = 0);
end Part;
model Pair
  Part left, right[2];
  Part spare if false;
end Pair;
model Wide
  extends Pair;
  parameter Real width = 3;
end Wide;
"""
OF_PART = ("gain", "offset", "y")


def look_at(text: str, *variables: str, **files: str) -> None:
    """The model M of a text, beside the classes above; further files by their names."""
    texts = {"M": text, **files, "Parts": PARTS}
    read = {n: (ROOT / f"{name}.mo", each) for n, (name, each) in enumerate(texts.items(), 1)}
    ir = Ir("M", {}, {}, {"variables": dict.fromkeys(variables)}, read, ROOT)
    refuse_unknown_modifiers(ir, Texts(ir))


def refused(text: str, *variables: str, **files: str) -> tuple[str | None, int | None, str]:
    with pytest.raises(BuildError) as caught:
        look_at(text, *variables, **files)
    return caught.value.file, caught.value.line, caught.value.message


def of(*paths: str) -> list[str]:
    """Variables of Parts at these paths."""
    return [f"{path}.{name}" if path else name for path in paths for name in OF_PART]


PAIR = of("p.left", "p.right[1]", "p.right[2]")


@pytest.mark.parametrize(
    ("declared", "wrong"),
    [
        # A name that begins its line belongs to this line, however deep it is
        ("Pair p(\nlefd = 1);", "lefd"),
        ("Pair p(left(\ngainn = 1));", "gainn"),
        ("Pair p(left(gain(\nstrat = 1)));", "strat"),
        ("Pair p(left(gain(start = 1)),\nrigth = 2);", "rigth"),
        ("Pair p(left(gain = 1),\nright(\ngain = 2,\noffsett = 3));", "offsett"),
        ("Pair p(\nleft(\ngain(\nmin = 0,\nmaxx = 3\n)\n)\n);", "maxx"),
        ("Pair p(left(gain = {1,\n2}, y(start = 2,\nfixd = true)));", "fixd"),
        ("Real a;\n  Pair p(left(gain = 1)),\n  q(left(y(\nstrat = 2)));", "strat"),
        # and so does one that ends it
        ("Pair p(\n  left(\n    gain = 1, gian\n = 2));", "gian"),
    ],
)
@pytest.mark.parametrize("before", [0, 3])
def test_an_unknown_name_is_in_the_line_where_it_is_written(
    declared: str, wrong: str, before: int
) -> None:
    """Whatever is before the class in its file; umlauts have two bytes."""
    text = "// \u00e4\u00f6\u00fc\n" * before + f"model M\n  {declared}\nend M;\n"
    line = text[: text.index(wrong)].count("\n") + 1
    variables = [*PAIR, *(name.replace("p.", "q.", 1) for name in PAIR)]
    file, found, message = refused(text, *variables)
    assert (file, found) == ("M.mo", line)
    assert message.startswith(f"there is no {wrong} to modify")


def test_a_name_in_the_part_of_a_part_is_of_the_file_that_has_it() -> None:
    """The model is right; the class that it uses has the wrong name, in its own file."""
    inner = "// one\nmodel Inner\n\n  Pair p(left(\ngainn = 1));\nend Inner;\n"
    variables = [f"i.{name}" for name in PAIR]
    file, line, message = refused("model M\n  Inner i;\nend M;\n", *variables, Inner=inner)
    assert (file, line) == ("Inner.mo", 5)
    assert message == "there is no gainn to modify; did you mean gain"


@pytest.mark.parametrize(
    ("declared", "message"),
    [
        ("Pair p(lefft = 1);", "there is no lefft to modify in Pair; did you mean left"),
        ("Pair p(xyz = 1);", "there is no xyz to modify in Pair"),
        ("Pair p(left(ofset = 1));", "there is no ofset to modify; did you mean offset"),
        ("Pair p(left(y(startt = 1)));", "there is no startt to modify; did you mean start"),
        ("Pair p(each final lefft = 1);", "there is no lefft to modify in Pair; did you mean left"),
        ("Pair p(right[1](ofset = 1));", "there is no ofset to modify; did you mean offset"),
        ("Pair p[3](lefft = 1);", "there is no lefft to modify in Pair; did you mean left"),
        ("inner replaceable Pair p(lefft = 1);",
         "there is no lefft to modify in Pair; did you mean left"),
        ("parameter Real gain(maxx = 1);", "there is no maxx to modify in Real; did you mean max"),
    ],
)  # fmt: skip
def test_the_nearest_name_is_offered(declared: str, message: str) -> None:
    assert refused(f"model M\n  {declared}\nend M;\n", "gain", *PAIR) == ("M.mo", 2, message)


@pytest.mark.parametrize(
    "declared",
    [
        "Pair p(left(gain = 1, offset(min = 0)), right(y(start = 2)));",
        "Pair p(spare(gain = 2, anything = 1));",  # a condition leaves it out
        "Pair p(redeclare model Kind = Other, replaceable Part left);",
        "Pair q(anything = 1) if false;",
        "Unknown u(anything = 1);",
        "// Pair p(lefft = 1);",
        'Pair p(left(gain = f("lefft = 1")));',
        "Pair p(left(gain = max(1, min(2, 3))));",
        "function F\n input Real x(strat = 1);\n end F;\n Pair p;",
        "Pair p;\nequation\n  connect(p.left(lefft = 1), p);",
    ],
)
def test_what_is_there_or_no_modifier_passes(declared: str) -> None:
    look_at(f"model M\n  {declared}\nend M;\n", *PAIR)


@pytest.mark.parametrize("attribute", ATTRIBUTES)
def test_every_attribute_of_the_language_may_be_given(attribute: str) -> None:
    """Modelica 3.6, 4.9: of a variable of the model itself and of a part."""
    look_at(f"model M\n  Real x({attribute} = 1);\n  Part p(y({attribute} = 1));\nend M;\n",
            "x", *of("p"))  # fmt: skip


@pytest.mark.parametrize(
    ("line", "is_known"),
    [
        ("extends Wide(width = 2);", True),
        ("extends Wide(left(gain = 2));", True),
        ("extends Wide(spare(gain = 2));", True),  # inherited, and left out
        ("extends Wide(widht = 2);", False),
        ("extends Wide(\nleft(gian = 2));", False),
    ],
)
def test_names_of_base_classes_are_there(line: str, is_known: bool) -> None:
    text = f"model M\n  {line}\nend M;\n"
    variables = ["width", *of("left", "right[1]", "right[2]")]
    if is_known:
        look_at(text, *variables)
    else:
        file, found, message = refused(text, *variables)
        wrong = message.split()[3]
        assert (file, found) == ("M.mo", text[: text.index(wrong)].count("\n") + 1)


@pytest.mark.parametrize("keyword", ["model", "block", "class"])
def test_a_short_class_has_modifiers_too(keyword: str) -> None:
    text = f"model M\n  {keyword} Other = Part(\n    gain = 1,\noffsett = 2);\n  Other o;\nend M;\n"
    assert refused(text, *of("o")) == (
        "M.mo", 4, "there is no offsett to modify in Part; did you mean offset",
    )  # fmt: skip
    look_at(text.replace("offsett", "offset"), *of("o"))
    # The words of a type are its attributes, which are not looked at here
    look_at("model M\n  type Length = Real(unitt = 1);\n  Length x;\nend M;\n", "x")


@pytest.mark.parametrize("keyword", ["model", "function", "record"])
@pytest.mark.parametrize(
    ("declared", "wrong"),
    [
        ("Pair p(redeclare {} K = Other,\n  lefft = 1);", "lefft"),
        ("Pair p(left(gain = 1), redeclare {} K = Other,\n  lefft = 1);", "lefft"),
        ("Pair p(redeclare {} K = Other, left(gain = 1,\n  offsett = 2));", "offsett"),
        (
            "Pair p(redeclare {} K = Lib.Other, redeclare {} L = Part,\n  lefft = 1);",
            "lefft",
        ),
        ("Pair p(redeclare {} K = Other(gain = 2), left(\n  gian = 2));", "gian"),
        # what is declared behind it
        ("Pair p(redeclare {} K = Other);\n  Pair q(\n lefft = 1);", "lefft"),
        ("Pair p(redeclare {} K = Other), q(\n  lefft = 1);", "lefft"),
        ("extends Pair(redeclare {} K = Other,\n  lefft = 1);", "lefft"),
        ("replaceable {} K = Other;\n  Pair p(\n  lefft = 1);", "lefft"),
    ],
)
def test_names_behind_a_class_of_a_list_are_looked_at(
    declared: str, wrong: str, keyword: str
) -> None:
    """A class that a modifier puts in ends with its element, not with the statement."""
    text = f"model M\n  {declared.replace('{}', keyword)}\nend M;\n"
    variables = [*PAIR, *(name.replace("p.", "q.", 1) for name in PAIR), *of("left", "right[1]")]
    file, line, message = refused(text, *variables)
    assert (file, line) == ("M.mo", text[: text.index(wrong)].count("\n") + 1)
    assert message.startswith(f"there is no {wrong} to modify")


@pytest.mark.parametrize(
    "declared",
    [
        "Pair p(redeclare model K = Other, left(gain = 1), redeclare Part left);",
        "Pair p(redeclare model K = Other(anything = 1), left(gain = 1));",
        "replaceable model K = Other(anything = 1);\n  Pair p(left(gain = 1));",
        # of a class that the model does not use
        "model K\n  Real x;\n  Part p(lefft = 1);\n  end K;\n  Pair p(left(gain = 1));",
        "replaceable model K = Part(lefft = 1);\n  Pair p(left(gain = 1));",
    ],
)
def test_right_names_beside_a_class_of_a_list_pass(declared: str) -> None:
    look_at(f"model M\n  {declared}\nend M;\n", *PAIR)
