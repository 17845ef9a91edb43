"""Outputs of two trials are compared; the step of a trial and the inputs that it moves."""

import math
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import variable

from axisrig.bench.tools.fmu import stepped_instance
from axisrig.bench.tools.fmu.stepped_instance import Reading, first_difference, not_finite, step_of
from axisrig.kernel.time.clock import MS


def reading(ms: int, *values: Any) -> Reading:
    bits = b"\0".join(stepped_instance._bits(value) for value in values)
    return Reading(ms * MS, bits, values)


OUTPUTS: Any = [SimpleNamespace(name=name) for name in ("a", "b")]


def test_runs_are_compared_bit_for_bit() -> None:
    same = [reading(0, (1.0,), (True,)), reading(1, (2.0,), (False,))]
    assert first_difference(same, list(same), OUTPUTS) is None
    for other, words in (
        ([same[0]], "one ends itself after 2 steps, the other after 1"),
        ([same[0], reading(1, (2.0,), (True,))], "b at t = 1 ms is False and True"),
        ([reading(0, (-1.0,), (True,)), same[1]], "a at t = 0 ms is 1.0 and -1.0"),
    ):
        assert first_difference(same, other, OUTPUTS) == words
    zero, minus = ([reading(0, (sign * 0.0,), (1,))] for sign in (1, -1))
    assert first_difference(zero, minus, OUTPUTS) == "a at t = 0 ms is 0.0 and -0.0"
    assert first_difference([reading(0, (math.nan,), (1,))], [reading(0, (math.nan,), (1,))],
                            OUTPUTS) is None  # fmt: skip
    long = [[reading(0, tuple(float(k + n) for k in range(30)), (1,))] for n in (0, 1)]
    assert str(first_difference(*long, OUTPUTS)).endswith("...")


def test_numbers_that_are_not_finite_are_named() -> None:
    for values, names in (
        (((1.0,), (2,)), []), (((math.inf,), (2,)), ["a"]), (((1.0,), (math.nan, 1.0)), ["b"]),
        (((-math.inf,), (math.nan,)), ["a", "b"]),
    ):  # fmt: skip
        assert not_finite(reading(0, *values), OUTPUTS) == names


@pytest.mark.parametrize(
    ("experiment", "fixed", "step_ns"),
    [
        ("0.002", "0.001", 2 * MS),
        (None, "0.0005", 500_000),
        ("nan", "0.0005", 500_000),
        ("0", None, stepped_instance.DEFAULT_STEP_NS),
        ("1e-10", None, stepped_instance.DEFAULT_STEP_NS),
        ("1e-9", None, 1),
        ("inf", "inf", stepped_instance.DEFAULT_STEP_NS),
        ("-1", None, stepped_instance.DEFAULT_STEP_NS),
    ],
)
def test_the_step_is_that_of_the_experiment_then_the_inner_one(
    experiment: str | None, fixed: str | None, step_ns: int
) -> None:
    description: Any = SimpleNamespace(
        defaultExperiment=None if experiment is None else SimpleNamespace(stepSize=experiment),
        coSimulation=SimpleNamespace(fixedInternalStepSize=fixed),
    )
    assert step_of(description) == step_ns


def test_inputs_move_within_their_limits_and_flags_change_once() -> None:
    description: Any = SimpleNamespace(
        modelVariables=[
            variable("plain"), variable("large", start="-2000"),
            variable("low", start="0", min="0"), variable("high", start="0", max="0.0005"),
            variable("flag", type="Boolean", start="true"), variable("off", type="Boolean"),
            variable("array", shape=(3,)), variable("clocked", clocks=["c"]),
            variable("out", causality="output"), variable("whole", type="Int32"),
        ]
    )  # fmt: skip

    def moved(count: int) -> dict[str, Any]:
        return {
            one.name: value
            for one, value in stepped_instance._moved_inputs(
                stepped_instance.movable_inputs(description), count
            )
        }

    assert moved(0) == {"plain": 0.0, "large": -2000.0, "low": 0.0, "high": 0.0, "flag": True,
                        "off": False}  # fmt: skip
    second = moved(2)
    assert second["plain"] == pytest.approx(2e-3)
    assert second["large"] == pytest.approx(-2000 + 4.0)
    assert (second["low"], second["high"]) == (pytest.approx(2e-3), 0.0005)
    assert moved(6)["low"] == 0.0
    assert moved(6)["plain"] == pytest.approx(-2e-3)
    assert moved(8) == moved(0)
    assert (moved(9)["flag"], moved(9)["off"]) == (True, False)
    assert (moved(10)["flag"], moved(10)["off"]) == (False, True)
