"""What of a compiled model stops the build, with the place of its word in the source."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import ONE, apply, parameter, variable
from axisrig.fmus.reading.ir import Ir, Source
from axisrig.fmus.reading.support import (
    refuse_undetermined,
    refuse_unknown_slots,
    refuse_unsupported,
)

TEXT = "// \u00e4 delay(x)\nmodel M\n  Real x = delay (time, 1);\n  Real y = previous(x);\nend M;\n"


def program(line_at: str, outputs: int = 1) -> dict[str, Any]:
    start = len(TEXT[: TEXT.index(line_at)].encode())
    return {"output_count": outputs, "span": {"source": 1, "start": start}}


def ir(**changed: Any) -> Ir:
    """A model that nothing is wrong with, but for what is changed; m and n have slots 4 and 5."""
    solve = {
        "solve_layout": {
            "pre_param_bindings": [{"clock_schedule": None}, {"clock_schedule": None}],
            "terminal_event_parameter_index": None,
        },
        "events": {"scheduled_root_conditions": []},
        "discrete": {
            "rhs_plan": {"programs": [program("Real x", 2)]},
            "guarded_assignment_plan": {"programs": [program("Real y")]},
            "update_targets": [{"P": {"index": 4}}, {"P": {"index": 9}}, {"P": {"index": 5}}],
            "observation_refresh": [False, True, False],
        },
        "artifacts": {"continuous": {"mass_matrix": {"kind": "identity"}}},
        "layout": {"bindings": {"m": {"P": {"index": 4}}, "n": {"P": {"index": 5}},
                                "x": {"Y": {"index": 0}}}},
    }  # fmt: skip
    temporal = {"delays": [], "terminals": [], "previous": []}
    for path, value in changed.items():
        *steps, last = path.split("__")
        part: Any = temporal if steps == ["temporal"] else solve
        for step in steps if steps != ["temporal"] else ():
            part = part[step]
        part[last] = value
    dae = {"systems": {"temporal": temporal}}
    return Ir("Lib.M", solve, dae, {}, {1: (Path("/lib/M.mo"), TEXT)}, Path("/lib"))


def test_a_model_of_what_is_known_passes() -> None:
    refuse_unsupported(ir())


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"solve_layout__pre_param_bindings": [{"clock_schedule": None}, {"clock_schedule": 1}]},
         "Lib.M: previous() on a clock is not supported"),
        ({"solve_layout__terminal_event_parameter_index": 0}, "Lib.M: terminal() is not supported"),
        ({"temporal__delays": [1]}, "M.mo:3: delay() is not supported"),
        ({"temporal__terminals": [1]}, "Lib.M: terminal() is not supported"),
        ({"temporal__previous": [1]}, "M.mo:4: previous() is not supported"),
        ({"events__scheduled_root_conditions": [1]},
         "Lib.M: a scheduled root condition is not supported"),
        ({"artifacts__continuous__mass_matrix__kind": "dense"},
         "Lib.M: a mass matrix is not supported"),
        ({"discrete__update_targets": [{"P": {"index": 4}}, {"P": {"index": 5}}]},
         "Lib.M: discrete equations and their targets do not match"),
        ({"discrete__observation_refresh": [True, False, False]},
         "M.mo:3: a discrete variable that changes without an event is not supported"),
        ({"discrete__observation_refresh": [False, False, True]},
         "M.mo:4: a discrete variable that changes without an event is not supported"),
    ],
)  # fmt: skip
def test_each_word_that_is_not_supported_stops_the_build(changed: Any, text: str) -> None:
    with pytest.raises(BuildError) as error:
        refuse_unsupported(ir(**changed))
    assert str(error.value) == text


def test_a_slot_that_nobody_writes_is_a_value_of_the_compiler() -> None:
    place = Source("M.mo", 7)
    rows = [(variable(3), None), (apply("Add", parameter(1), parameter(2)), place)]
    refuse_unknown_slots(ir(), rows, {1, 2})
    for known in ({1}, {2}, set()):
        with pytest.raises(BuildError, match=r"M\.mo:7: an internal value"):
            refuse_unknown_slots(ir(), rows, known)
    refuse_unknown_slots(ir(), [(ONE, None)], set())


@pytest.mark.parametrize(
    ("role", "determined", "is_refused"),
    [
        ("discrete_real", {4, 5}, False), ("discrete_value", {4}, True),
        ("discrete_real", {5}, True), ("parameter", set(), False),
        ("discrete_value", {4, 5, 6}, False),
    ],
)  # fmt: skip
@pytest.mark.parametrize("count", [1, 2])
def test_a_discrete_variable_has_an_equation_for_each_element(
    role: str, determined: set[int], is_refused: bool, count: int
) -> None:
    found = ir()
    declared = {"name": "m", "role": role, "scalar_count": count, "declaration": {"span": None}}
    found.dae["variables"] = [declared]  # type: ignore[index]
    if not is_refused or (count == 1 and 4 in determined):
        refuse_undetermined(found, determined)
        return
    with pytest.raises(BuildError, match="lost the equation of m") as error:
        refuse_undetermined(found, determined)
    assert ("each element" in str(error.value)) is (count > 1)


@pytest.mark.parametrize("before", ["", "  Real a = mydelay(1);\n", "// " + 60 * "\u00e4" + "\n"])
def test_a_word_is_found_whole_and_at_its_own_line(before: str) -> None:
    """A longer name that ends with it is another one, and letters of two bytes count as two."""
    found = ir(temporal__delays=[1])
    text = f"{before}model M\n{before}  Real x = delay(time, 1);\nend M;\n"
    found.files[1] = (Path("/lib/M.mo"), text)  # type: ignore[index]
    with pytest.raises(BuildError) as error:
        refuse_unsupported(found)
    assert error.value.line == text[: text.index("x = delay")].count("\n") + 1


def test_a_lost_equation_is_named_at_the_declaration_of_its_variable() -> None:
    found = ir()
    start = len(TEXT[: TEXT.index("Real y")].encode())
    span = {"source": 1, "start": start}
    declared = {"name": "m", "role": "discrete_value", "scalar_count": 1}
    for given, words in ((span, "M.mo:4: "), (None, "Lib.M: ")):
        found.dae["variables"] = [{**declared, "declaration": {"span": given}}]  # type: ignore[index]
        with pytest.raises(BuildError) as error:
            refuse_undetermined(found, {5})
        assert str(error.value) == f"{words}the compiler lost the equation of m"


def test_a_variable_without_a_slot_of_p_needs_no_discrete_equation() -> None:
    found = ir()
    for name in ("x", "nobody"):
        declared = {"name": name, "role": "discrete_real", "scalar_count": 1, "declaration": {}}
        found.dae["variables"] = [declared]  # type: ignore[index]
        refuse_undetermined(found, set())


def test_variables_are_no_internal_values_of_the_compiler() -> None:
    """Slot 3 of y is known whether slot 3 of p is or not."""
    rows = [(apply("Add", variable(3), parameter(2)), Source("M.mo", 7))]
    refuse_unknown_slots(ir(), rows, {2})
    with pytest.raises(BuildError, match="an internal value of the compiler"):
        refuse_unknown_slots(ir(), [(parameter(3), None)], {2})
