"""Modifiers that the compiler drops are refused with their line, and those that act pass.

Nothing is compiled: the texts of a model, and variables as the compiler describes them.
"""

from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.modifiers import refuse_dropped_modifiers, shared_numbers

ROOT = Path("/models")
OF_CLASS = "drops the modifier of a class in redeclare and constrainedby; modify the component"


def look_at(*texts: str) -> None:
    """A model M in the first of these texts."""
    files = {n: (ROOT / f"F{n}.mo", text) for n, text in enumerate(texts, 1)}
    refuse_dropped_modifiers(Ir("Lib.M", {}, {}, {}, files, ROOT))


def model(line: str, name: str = "M") -> str:
    return f"// \u00e4 first\nmodel {name}\n  Real x;\n  {line}\nend {name};\n"


BASE = "model Base\n  replaceable Part part(k = 1);\nend Base;\n"
HEIR = "model Heir\n  extends Base;\nend Heir;\n"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Base b(redeclare model P = Part(k = 5));", OF_CLASS),
        ("Base b(redeclare final replaceable block P = Lib.Part(k = 5));", OF_CLASS),
        ("replaceable model P = Part constrainedby Any(k = 6);", OF_CLASS),
        ("replaceable model P = Part(k = 6) constrainedby Any(k = 6);", OF_CLASS),
        ("replaceable Part p constrainedby Any(k = 6);", OF_CLASS),
        ("replaceable Part p(g = 6) constrainedby Any(k = 6);", OF_CLASS),
        ("replaceable Part p(k = 6) constrainedby Any(k = 6, g = 2);", OF_CLASS),
        ("Whole w(base(redeclare Other part));", "redeclare inside the modifier of a modifier"),
        ("Whole w(a = 1, base(g = 2, redeclare final Other part));", "the modifier of a modifier"),
        ("extends Heir(redeclare Other part);", "redeclare of part, which Heir inherits; extend"),
        ("extends Lib.Heir(g = 1, redeclare model Kind = Other);", "redeclare of Kind, which Heir"),
        ("extends Base(redeclare Other another);", "redeclare of another, which Base inherits"),
    ],
)
def test_a_modifier_without_effect_is_refused_with_its_line(line: str, words: str) -> None:
    with pytest.raises(BuildError, match=words) as caught:
        look_at(model(line), BASE + HEIR)
    assert (caught.value.file, caught.value.line) == ("F1.mo", 4)


@pytest.mark.parametrize(
    "line",
    [
        "Base b(redeclare model P = Part);", "Base b(redeclare Other part(k = 5));",
        "replaceable Part p(k = 6) constrainedby Any(k = 6);",
        "replaceable Part p(k = 6, g = 1) constrainedby Any(k = 6);",
        "replaceable Part p constrainedby Any;", "extends Base(redeclare Other part);",
        "extends Lib.Base(redeclare Other part(k = 5));",
        # A text and a note are no code
        "// Base b(redeclare model P = Part(k = 5));",
        'Real y = f("redeclare model P = Part(k = 5)");',
    ],
)  # fmt: skip
def test_a_modifier_that_acts_passes(line: str) -> None:
    look_at(model(line), BASE + HEIR)


def test_only_classes_that_a_model_uses_are_looked_at_and_each_has_its_own_file() -> None:
    bad = "Base b(redeclare model P = Part(k = 5));"
    look_at(model("Good g;"), model(bad, "Bad"), model("Real y;", "Good"))
    with pytest.raises(BuildError) as caught:
        look_at(model("Good g;"), model(bad, "Bad"), model("Bad b;", "Good"))
    assert (caught.value.file, caught.value.line) == ("F2.mo", 4)


# Numbers that two parameters have from one place

TEXT = "model M\n  A a(k = 5);\n  parameter Real q = 7;\nend M;\n"
FIVE = TEXT.index("5")


def variable(name: str, slot: int, *, at: int = FIVE, own: int = 0, **given: Any) -> Any:
    """A parameter whose number is at a place of the text; own: where it is declared."""
    elements = given.pop("elements", [name])
    values = {
        "name": name, "role": "parameter", "scalar_names": elements,
        "value_type": {"dimensions": [len(elements)] if len(elements) > 1 else []},
        "attributes": {"binding": 0}, "declaration": {"span": {"source": 2, "start": own}},
    }  # fmt: skip
    return {**values, **given, "slot": slot, "at": at}


def shared(*variables: Any, variability: str = "constant", source: int = 1) -> list[Any]:
    expressions, bindings, kept = [], {}, []
    for number, each in enumerate(variables):
        file = each.get("source", source)
        span = {"source": file, "start": each["at"], "end": each["at"] + 1}
        expressions.append({"provenance": {"span": span}, "variability": variability})
        for place, name in enumerate(each["scalar_names"]):
            vector = each.get("vector", "P")
            bindings[name] = {vector: {"index": each["slot"] + place}}
        has = each["attributes"]["binding"] is not None
        kept.append({**each, "attributes": {"binding": number if has else None}})
    dae = {"variables": kept, "expressions": expressions}
    files = {1: (ROOT / "F1.mo", TEXT), 2: (ROOT / "F2.mo", "")}
    ir = Ir("M", {"layout": {"bindings": bindings}}, dae, {}, files, ROOT)
    return [(own, other, str(place)) for own, other, place in shared_numbers(ir)]


def test_a_parameter_inside_follows_the_nearest_one_around_it() -> None:
    """a.k, a.b.k and a.b.c.k have their number from `k = 5` of a: each follows the one outside."""
    inner = [variable("a.b.c.k", 7), variable("a.k", 3), variable("a.b.k", 5)]
    assert sorted(shared(*inner)) == [(5, 3, "F1.mo:2"), (7, 5, "F1.mo:2")]


def test_elements_of_an_array_follow_one_by_one() -> None:
    outer = variable("a.k", 3, elements=["a.k[1]", "a.k[2]"])
    inside = variable("a.b.k", 8, elements=["a.b.k[1]", "a.b.k[2]"])
    assert shared(outer, inside) == [(8, 3, "F1.mo:2"), (9, 4, "F1.mo:2")]


@pytest.mark.parametrize(
    "other",
    [
        variable("c.k", 5), variable("ab.b.k", 5), variable("a.b.g", 5),
        variable("a.b.k", 5, at=TEXT.index("7")), variable("a.b.k", 5, role="state"),
        variable("a.b.k", 5, attributes={"binding": None}), variable("a.b.k", 5, vector="Y"),
        variable("a.b.k", 5, elements=["a.b.k[1]", "a.b.k[2]"]),
    ],
)  # fmt: skip
def test_what_is_not_inside_or_has_another_number_follows_nothing(other: Any) -> None:
    """Beside it, of another name, of another place, of another shape, or no parameter."""
    assert shared(variable("a.k", 3), other) == []


def test_a_number_that_is_calculated_or_in_no_file_is_shared_by_nobody() -> None:
    pair = variable("a.k", 3), variable("a.b.k", 5)
    assert len(shared(*pair)) == 1
    assert shared(*pair, variability="parameter") == []
    assert shared(*pair, source=9) == []


@pytest.mark.parametrize(("own", "is_shared"), [(0, True), (TEXT.index("A a"), False)])
def test_a_number_in_the_declaration_of_a_parameter_is_its_own(own: int, is_shared: bool) -> None:
    """Between a declaration and a number that is given from outside there is a semicolon."""
    text_place = {"span": {"source": 1, "start": own}}
    first = variable("a.k", 3, declaration=text_place)
    second = variable("a.b.k", 5, at=FIVE)
    at = TEXT.index("7")
    if is_shared:
        first, second = ({**one, "at": at} for one in (first, second))
        assert len(shared(first, second)) == 1
    else:
        assert shared(first, second) == []


def test_the_same_place_of_two_files_is_two_places() -> None:
    """Each parameter follows the one around it whose number is in the same file."""
    names = ("a.k", "a.b.k", "a.b.c.k", "a.b.c.d.k")

    def found(*files: int) -> list[Any]:
        """The parameters with their numbers in these files, declared in none of them."""
        made = [variable(name, slot, declaration={}) for slot, name in enumerate(names)]
        return sorted(shared(*({**m, "source": f} for m, f in zip(made, files, strict=False))))

    assert found(1, 2) == found(2, 1) == []
    assert found(2, 2) == [(1, 0, "F2.mo:1")]
    assert found(1, 2, 1, 2) == [(2, 0, "F1.mo:2"), (3, 1, "F2.mo:1")]


def test_a_parameter_of_the_model_itself_is_around_all_others() -> None:
    """Of `extends Base(k = 5)` the number is that of k, and of `A a(k = k)` in Base."""
    assert shared(variable("k", 2), variable("a.k", 4)) == [(4, 2, "F1.mo:2")]
    both = shared(variable("a.b.k", 6), variable("k", 2), variable("c.k", 8))
    assert sorted(both) == [(6, 2, "F1.mo:2"), (8, 2, "F1.mo:2")]


@pytest.mark.parametrize(("own", "other"), [([2, 3], [3, 2]), ([6], [2, 3]), ([6], [1, 6])])
def test_as_many_elements_in_another_shape_follow_nothing(own: Any, other: Any) -> None:
    pair = [
        variable(name, slot, value_type={"dimensions": shape},
                 elements=[f"{name}[{k}]" for k in range(6)])
        for name, slot, shape in (("a.k", 10, own), ("a.b.k", 20, other))
    ]  # fmt: skip
    assert shared(*pair) == []
    same = [{**one, "value_type": {"dimensions": own}} for one in pair]
    assert [(a, b) for a, b, _ in shared(*same)] == [(20 + k, 10 + k) for k in range(6)]
