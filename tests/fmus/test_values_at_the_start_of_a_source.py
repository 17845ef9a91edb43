"""What the C source of a model is given: start values, whose licence it has, its tables."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_parts_of_a_c_source import source
from tests.fmus.test_variables_of_models import shown

from axisrig.fmus.equations.system import Assignment
from axisrig.fmus.reading.expressions import apply, const, variable
from axisrig.fmus.writing import source as writing


class Given:
    """Takes what a template is filled with, in place of the template."""

    def __init__(self) -> None:
        self.words: dict[str, Any] = {}

    def __call__(self, **_filters: Any) -> "Given":
        return self

    def get_template(self, name: str) -> "Given":
        assert name == "model.c.jinja"
        return self

    def render(self, **words: Any) -> str:
        self.words = words
        return "text"


def given(patch: pytest.MonkeyPatch, **more: Any) -> dict[str, Any]:
    """What the source of a model with y 1, 2, 3 and p 4, 5 is made of."""
    template = Given()
    patch.setattr(writing, "templates", template)
    patch.setattr(writing, "start_vectors", lambda *_: ([1.0, 2.0, 3.0], [4.0, 5.0]))
    patch.setattr(writing, "early_levels", lambda *_: [])
    ir: Any = SimpleNamespace(
        model=more.pop("model", "Lib.Part"),
        solve={"layout": {"bindings": {}}, "solve_layout": {"solver_maps": {"names": ["x"]}}},
    )
    variables, folded = more.pop("variables", []), more.pop("folded", [])
    system: Any = SimpleNamespace(state_count=0, blocks=[], **{"twins": []} | more)
    writing.write_source(ir, system, variables, folded, 5e-5, "fmi3.inc")
    return template.words


@pytest.mark.parametrize(
    ("twins", "values"),
    [([], [1, 2, 3]), ([(0, 2)], [3, 2, 3]), ([(0, 2), (1, 2)], [3, 3, 3]), ([(2, 0)], [1, 2, 1])],
)
def test_a_state_of_the_compilers_own_begins_where_its_variable_does(
    twins: list[tuple[int, int]], values: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Behind the last value comes a 0: C has no empty arrays."""
    words = given(monkeypatch, twins=twins)
    assert words["start_y"] == [repr(float(value)) for value in [*values, 0]]
    assert words["start_p"] == ["4.0", "5.0", "0.0"]


@pytest.mark.parametrize(
    ("model", "is_own"),
    [("AxisRig.Drives.ServoAxis", True), ("AxisRig", True), ("AxisRigs.Servo", False),
     ("Lib.AxisRig", False), ("Lib.Part", False)],
)  # fmt: skip
def test_a_model_is_of_the_library_by_the_first_part_of_its_name(
    model: str, is_own: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert given(monkeypatch, model=model)["is_own"] is is_own


def test_folded_parameters_come_in_their_order_and_variables_as_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = [shown(name="b", vector="p", index=4, minimum=0.0), shown(name="a", maximum=0.0)]
    words = given(monkeypatch, folded={7, 2, 5}, variables=made)
    assert words["folded"] == [2, 5, 7]
    assert [row["name"] for row in words["variables"]] == ["b", "a"]
    assert [(row["min"], row["max"]) for row in words["variables"]] == [
        ("0.0", "INFINITY"), ("-INFINITY", "0.0"),
    ]  # fmt: skip
    assert (words["step"], words["y_names"]) == ("5e-05", ["x"])


@pytest.mark.parametrize("count", [1, 50, 51, 120])
def test_a_derivative_has_every_equation_of_its_chain(count: int) -> None:
    """However long it is; in order, and none that it does not need."""
    rows = [
        Assignment("y", 1 + n, apply("Mul", const(2.0), variable(n)), None) for n in range(count)
    ]
    beside = Assignment("y", 500, apply("Mul", const(3.0), variable(0)), None)
    derivative = Assignment("y", 0, variable(count), None)
    body = source(state_count=1, derivatives=[derivative], algebraics=[beside, *rows]).derivatives()
    names = [line.split()[2] for line in body.splitlines() if line.split()[0] == "const"]
    assert names == [f"y{n}" for n in range(1, count + 1)]
    assert body.splitlines()[-1].strip() == f"dx[0] = y{count};"
