"""Names of modifiers in parts that a base class brings, all names near one, and brackets before.

Nothing is compiled: texts of classes, and the variables that the compiler has flattened.
"""

import pytest
from tests.fmus.test_modifiers_without_effect import BASE, HEIR, model
from tests.fmus.test_modifiers_without_effect import look_at as look_at_dropped
from tests.fmus.test_names_of_modifiers import look_at, of, refused

from axisrig.fmus.reading.classes import class_names
from axisrig.fmus.reading.errors import BuildError

BASES = {
    "Mid": "model Mid\n  Pair p;\nend Mid;\n",
    "Deep": "model Deep\n  extends Mid;\n  Real z;\nend Deep;\n",
    "Deeper": "model Deeper\n  extends Deep;\nend Deeper;\n",
}
OF_P = of("d.p.left", "d.p.right[1]", "d.p.right[2]")


@pytest.mark.parametrize("kind", ["Mid", "Deep", "Deeper"])
def test_a_part_that_a_condition_leaves_out_may_be_modified_in_an_inherited_part(kind: str) -> None:
    """`spare` has no variables; that it is there says the class of p, which any base declares."""
    text = f"model M\n  {kind} d(p(left(gain = 2),\n    spare(gain = 2)));\nend M;\n"
    look_at(text, *OF_P, **BASES)
    wrong = text.replace("spare", "spaer")
    assert refused(wrong, *OF_P, **BASES)[:2] == ("M.mo", 3)


def near(declared: str, *variables: str, **files: str) -> set[str]:
    message = refused(f"model M\n  {declared}\nend M;\n", *variables, **files)[2]
    before, sign, after = message.partition("; did you mean ")
    assert before.startswith("there is no ")
    return set(after.split(" or ")) if sign else set()


def test_every_name_that_is_near_is_offered() -> None:
    """Three at most; none where nothing is near."""
    names = [f"t.gain_{end}" for end in ("x", "y", "z")]
    kind = "model Three\n  Real gain_x, gain_y, gain_z;\nend Three;\n"
    assert near("Three t(gain_w = 1);", *names, Three=kind) == {"gain_x", "gain_y", "gain_z"}
    assert near("Three t(gain_w = 1);", *names[:2], Three=kind.replace(", gain_z", "")) == {
        "gain_x",
        "gain_y",
    }
    assert near("Three t(q = 1);", *names, Three=kind) == set()


@pytest.mark.parametrize(
    "before",
    [
        "k(start = 1)",
        "k = f(1)",
        "k(start = 1), g(fixed = true)",
        "k(a(start = 1), b(start = 2)), g = f(g(1))",
        "k = {f(1), f(2)}",
    ],
)
def test_brackets_that_are_closed_before_a_redeclare_are_none_around_it(before: str) -> None:
    look_at_dropped(model(f"Base b({before}, redeclare Other part);"), BASE + HEIR)
    look_at_dropped(model(f"extends Base({before}, redeclare Other part);"), BASE + HEIR)
    with pytest.raises(BuildError, match="redeclare inside the modifier of a modifier"):
        look_at_dropped(model(f"Whole w({before}, b({before}, redeclare Other part));"), BASE)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("model A model B end B; model C end C;", ["A"]),
        ("model A end A; model B model C end C;", ["A", "B"]),
        ("model A end B; model B end B;", ["A"]),
    ],
)
def test_a_class_that_nothing_ends_goes_to_the_end_of_its_file(text: str, names: list[str]) -> None:
    assert class_names(text) == names
