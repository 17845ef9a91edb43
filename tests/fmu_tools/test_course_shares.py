"""By which share of its range an output differs with the steps in which it is asked for."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.fmu.courses import _differing, _numbers
from axisrig.kernel.time.clock import MS


def outputs(*kinds: tuple[str, str | None]) -> Any:
    return [
        SimpleNamespace(name=f"out_{place}", type=kind, variability=variability)
        for place, (kind, variability) in enumerate(kinds)
    ]


def course(*columns: list[Any]) -> Any:
    """A reading each step; a column has the elements of one output."""
    return [
        SimpleNamespace(values=[value if isinstance(value, list) else [value] for value in row])
        for row in zip(*columns, strict=True)
    ]


REAL = ("Float64", None)


@pytest.mark.parametrize(
    ("fine", "share"),
    [
        ([0.0, 7.0, 500.0, 7.0, 1000.0], None),
        ([0.0, 7.0, 501.0, 7.0, 1000.0], None),  # 1 of 1000 is the limit
        ([0.0, 7.0, 501.5, 7.0, 1000.0], 0.0015),
        ([0.0, 7.0, 498.0, 7.0, 1000.0], 0.002),
        ([0.0, 9e9, 500.0, -9e9, 1000.0], None),  # between the common instants
        ([0.0, 7.0, 500.0, 7.0, 1500.0], 1 / 3),  # the range has both courses in it
    ],
)
def test_courses_are_compared_at_common_instants(fine: list[float], share: float | None) -> None:
    """In steps of 1 ms 0, 500 and 1000; in steps of 0.5 ms every second one."""
    courses = {MS: course([0.0, 500.0, 1000.0]), MS // 2: course(fine)}
    found = list(_differing(courses, outputs(REAL)))
    if share is None:
        assert found == []
    else:
        ((name, step_ns, by),) = found
        assert (name, step_ns) == ("out_0", MS // 2)
        assert by == pytest.approx(share)


def test_an_output_that_stands_still_differs_by_nothing() -> None:
    courses = {MS: course([3.0, 3.0]), MS // 4: course([3.0] * 5)}
    assert list(_differing(courses, outputs(REAL))) == []


def test_each_output_and_each_step_is_looked_at() -> None:
    courses = {
        MS: course([0.0, 1.0], [0.0, 1.0]),
        MS // 2: course([0.0, 5.0, 1.0], [0.0, 5.0, 0.5]),
        MS // 4: course([0.0, 5.0, 5.0, 5.0, 0.9], [0.0, 5.0, 5.0, 5.0, 1.0]),
    }
    found = [(name, step) for name, step, _ in _differing(courses, outputs(REAL, REAL))]
    assert found == [("out_1", MS // 2), ("out_0", MS // 4)]


def test_continuous_real_numbers_have_a_course_alone() -> None:
    """FMI 2 and 3: Real, Float32 and Float64; what is discrete may jump as it likes."""
    kinds = [("Real", "continuous"), ("Float32", None), ("Float64", "discrete"), ("Integer", None),
             ("Boolean", "discrete"), ("String", None)]  # fmt: skip
    row = [[1.0, 2.0]] * 6
    assert [name for name, _ in _numbers(course(*row), outputs(*kinds))] == ["out_0", "out_1"]
    several = course([[1.0, 5.0], [2.0, 6.0]])
    assert list(_numbers(several, outputs(REAL))) == [
        ("out_0[..]", [1.0, 2.0]),
        ("out_0[..]", [5.0, 6.0]),
    ]
    assert list(_numbers([], outputs(REAL))) == []
