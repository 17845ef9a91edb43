"""Every call of a branch, every class that a class uses, every place of a part: not only the first.

Nothing is compiled: calls and texts of classes.
"""

import pytest
from tests.fmus.test_calls_of_several_equations import named, owners, program
from tests.fmus.test_function_operations import pure_call
from tests.fmus.test_names_of_modifiers import look_at, of, refused

from axisrig.fmus.reading.classes import used_classes
from axisrig.fmus.reading.expressions import Expr, parameter, variable

CONST = {"kind": "Const", "value": 1.0, "value_class": "finite", "dst": 9}


@pytest.mark.parametrize("variability", ["continuous", "discrete", "parameter"])
def test_a_call_that_is_left_at_run_time_counts_however_seldom_it_changes(variability: str) -> None:
    calls = [named(10, 15, 5, variability=variability), named(20, 25, 6, variability="constant")]
    assert owners(calls, [program((0, 30), 1)]) == {1: 5}


@pytest.mark.parametrize("place", [0, 1, 2])
def test_all_operations_of_a_branch_are_looked_through(place: int) -> None:
    """Two calls and a number in condition, result and end, in whatever order."""
    parts = []
    for first in (1, 3, 5):
        ops = [pure_call(first), pure_call(first + 1)]
        parts.append({"ops": [*ops[:place], CONST, *ops[place:]]})
    branch = {
        "kind": "FunctionConditional", "arms": [{"condition": parts[0], "result": parts[1]}],
        "fallback": parts[2],
    }  # fmt: skip
    calls = [named(10 * number, 10 * number + 5, 30 + number) for number in range(1, 7)]
    whole = {"span": {"source": 1, "start": 0, "end": 70}, "ops": [CONST, branch]}
    assert owners(calls, [whole]) == {number: 30 + number for number in range(1, 7)}


@pytest.mark.parametrize("blank", [" ", "   ", "\n  ", "\t"])
def test_a_loop_ends_however_far_its_words_are_apart(blank: str) -> None:
    """Of `end for` the words may be on two lines; what comes behind it is another statement."""
    text = f"y = 1; for i in 1:2 loop v[i] = x; end{blank}for; w = f(1); z = g(2);"
    at = {name: text.index(f"{name}(") for name in "fg"}
    calls = [named(start, start + 4, 5 + n) for n, start in enumerate(at.values())]
    loop = text.index("for i")
    names = [program((text.index(word), text.index(word) + 1), n) for n, word in
             enumerate(("w =", "z ="))]  # fmt: skip
    assert owners(calls, names, text) == {0: 5, 1: 6}
    inside = text.replace("= x;", "= h(i);")
    shift = len("h(i)") - len("x")
    calls = [named(start + shift, start + shift + 4, 5 + n) for n, start in enumerate(at.values())]
    calls.append(named(inside.index("h("), inside.index("h(") + 4, 9))
    assert owners(calls, [program((loop, loop + 3), 7)], inside) == {7: 9}


def test_a_class_reaches_all_that_it_uses() -> None:
    """However many parts it has, and whatever these have."""
    text = """model M A a; B b; C c; end M; model A D d; E e; end A; model B end B;
model C F f; end C; model D end D; model E end E; model F end F; model G M m; end G;"""
    found = [body.text.split()[0] for body in used_classes({1: text}, "M")]
    assert found[0] == "M"
    assert sorted(found) == ["A", "B", "C", "D", "E", "F", "M"]


def test_each_node_of_an_expression_comes_once() -> None:
    x, p = variable(0), parameter(0)
    both = Expr("Add", (x, p))
    whole = Expr("Mul", (Expr("Mul", (both, both)), Expr("Sub", (both, x))))
    found = list(whole.nodes())
    assert len(found) == 6
    assert set(found) == {whole, *whole.args, both, x, p}
    assert sorted(leaf.kind for leaf in whole.leaves()) == ["p", "y"]


HOLDER = (
    "model Holder\n  parameter Boolean use = true;\n  Pair p(lefd(gain = 2)) if use;\nend Holder;\n"
)


@pytest.mark.parametrize("order", [1, -1])
def test_a_part_is_looked_at_wherever_its_class_stands(order: int) -> None:
    """One holder leaves its part out by a condition, the other has it: there lefd is none."""
    text = "model M\n  Holder a, b;\nend M;\n"
    one, other = ("a", "b")[::order]
    having = of(f"{one}.p.left", f"{one}.p.right[1]", f"{one}.p.right[2]")
    look_at(text, "a.use", "b.use", Holder=HOLDER)
    found = refused(text, *having, f"{other}.use", f"{one}.use", Holder=HOLDER)
    assert found[:2] == ("Holder.mo", 3)


def test_a_model_without_any_variable_has_its_modifiers_looked_at() -> None:
    text = "model M\n  extends Empty(\n    nothing = 1);\nend M;\n"
    assert refused(text, Empty="model Empty\nend Empty;\n")[:2] == ("M.mo", 3)


@pytest.mark.parametrize("word", ["import", "within", "annotation"])
def test_what_is_no_declaration_declares_no_name(word: str) -> None:
    """`import Other;` makes no part Other that could be modified."""
    kind = f"model Kind\n  {word} Other;\n  Real x;\nend Kind;\n"
    text = "model M\n  Kind k(x(start = 1),\n    Other = 2);\nend M;\n"
    assert refused(text, "k.x", Kind=kind)[:2] == ("M.mo", 3)
