"""Classes inside others, of one name in two packages, and several bases: texts of models alone."""

import pytest
from tests.fmus.test_modifiers_without_effect import BASE, model
from tests.fmus.test_modifiers_without_effect import look_at as look_at_dropped
from tests.fmus.test_names_of_modifiers import look_at, of, refused
from tests.fmus.test_words_of_models import texts

from axisrig.fmus.reading.classes import class_names
from axisrig.fmus.reading.errors import BuildError


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("package P model Q end Q; end P; model R end R;", ["P", "R"]),
        ("model A model B model C end C; end B; end A;", ["A"]),
        ("block A record B end B; record C end C; end A; block D end D;", ["A", "D"]),
        ("model A // model B end B;\nend A;", ["A"]), ('model A "model B end B;" end A;', ["A"]),
    ],
)  # fmt: skip
def test_the_classes_of_a_file_are_those_that_no_other_holds(text: str, names: list[str]) -> None:
    """A file holds one model of its name, whatever this one holds."""
    assert class_names(text) == names


@pytest.mark.parametrize("order", [1, -1])
def test_what_any_class_of_a_name_declares_may_be_redeclared(order: int) -> None:
    """Of two packages with a class Base the text alone does not say which is meant."""
    line, other = model("extends Base(redeclare Other part);"), "model Base\n  Real y;\nend Base;\n"
    look_at_dropped(line, *[BASE, other][::order])
    with pytest.raises(BuildError, match="redeclare of part, which Base inherits"):
        look_at_dropped(line, other)


@pytest.mark.parametrize("prefix", ["redeclare", "replaceable", "redeclare replaceable"])
def test_a_declaration_among_modifiers_is_no_name(prefix: str) -> None:
    """`p(replaceable Part spare)`: the word before it is one of the language."""
    line = f"Pair p({prefix} Part spare, left(gain = 1));"
    look_at(f"model M\n  {line}\nend M;\n", *of("p.left", "p.right[1]"))
    wrong = line.replace("gain", "gian")
    _, _, message = refused(f"model M\n  {wrong}\nend M;\n", *of("p.left", "p.right[1]"))
    assert "there is no gian" in message


def test_a_class_inside_a_class_has_a_name_that_may_be_modified() -> None:
    """One of a base class too; what is none is refused with the names that are near."""
    inside = "model Holds\n  model Inner\n    Real z;\n  end Inner;\n  Real y;\nend Holds;\n"
    inside += "model Heir\n  extends Holds;\nend Heir;\n"
    for kind in ("Holds", "Heir"):
        look_at(f"model M\n  {kind} h(Inner(z = 1));\nend M;\n", "h.y", Inside=inside)
        _, line, message = refused(
            f"model M\n  {kind} h(Innner(z = 1));\nend M;\n", "h.y", Inside=inside
        )
        assert (line, message) == (2, f"there is no Innner to modify in {kind}; did you mean Inner")


def test_bases_come_level_by_level_each_once() -> None:
    """What a class extends itself, in its order, before what these extend (icons, documents)."""
    found, _ = texts(
        "model A extends B; extends C; end A; model B extends D; end B;"
        " model C extends E; extends D; end C; model D end D; model E end E;"
        .replace("; ", ";\n"), "A.mo",
    )  # fmt: skip
    assert [one.name for one in found.bases("A")] == ["A", "B", "C", "D", "E"]
    assert [one.name for one in found.bases("C")] == ["C", "E", "D"]
    assert [one.name for one in found.bases("D")] == ["D"]


@pytest.mark.parametrize(
    ("written", "title"),
    [
        (r"of C:\\data", r"of C:\data"), (r"a \"word\"", 'a "word"'), (r"two \\\\", r"two \\"),
        (r"a \\\"b\\\"", r'a \"b\"'), ("plain", "plain"),
    ],
)  # fmt: skip
def test_a_sign_behind_a_backslash_is_itself(written: str, title: str) -> None:
    """Modelica 3.6, 2.4.4: two backslashes are one, and one before a quotation mark is none."""
    found, _ = texts(f'model A "{written}"\nend A;', "A.mo")
    kind = found.get("A")
    assert kind is not None
    assert kind.title == title
