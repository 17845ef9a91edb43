"""The course of outputs in steps of different length, of FMUs that are written down here."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.fmu import courses
from axisrig.bench.tools.fmu.courses import course_findings
from axisrig.bench.tools.fmu.stepped_instance import Reading
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.time.clock import MS, US

Output = Callable[[int, int], float]
"""Gives the value of an output from the time and the length of its last step, ns."""


def smooth(time_ns: int, _: int) -> float:
    return time_ns / MS


def held(period_ns: int) -> Output:
    """Return an output that is new each period, as that of a digital controller."""
    return lambda time_ns, _: time_ns // period_ns * 1.0


def findings(
    *outputs: Output,
    patch: pytest.MonkeyPatch,
    inner_ns: int = 0,
    kind: str = "Float64",
    variability: str = "continuous",
    refused_ns: tuple[int, ...] = (),
) -> list[tuple[str, str]]:
    """Level and text of what is found about an FMU with these outputs."""

    class Trial:
        def __init__(self, _: Path, *, moves: bool, drifts: bool = False) -> None:
            assert moves
            self.outputs: Any = [
                SimpleNamespace(name=f"out{n}", type=kind, variability=variability)
                for n in range(len(outputs))
            ]
            self.count = self._time_ns = self._step_ns = 0

        def start(self) -> None: ...

        def close(self) -> None: ...

        def step(self, step_ns: int) -> Reading:
            self._time_ns, self._step_ns = self._time_ns + step_ns, step_ns
            return self._read()

        def course(self, step_ns: int, span_ns: int) -> list[Reading]:
            if step_ns in refused_ns:
                raise PlantError("trial", self._time_ns, "no such steps")
            return [self._read(), *(self.step(step_ns) for _ in range(span_ns // step_ns))]

        def _read(self) -> Reading:
            values = tuple((output(self._time_ns, self._step_ns),) for output in outputs)
            return Reading(self._time_ns, b"", values)

    patch.setattr(courses, "Trial", Trial)
    return [(one.level, one.text) for one in course_findings(Path("a.fmu"), inner_ns)]


AGREE = [("ok", "courses in steps of 1, 0.25 and 0.05 ms agree")]


@pytest.mark.parametrize(
    ("outputs", "held_ms"),
    [
        ((smooth,), None),
        ((held(MS),), "1"),
        ((smooth, held(MS)), None),  # one of them is that of a digital controller
        ((held(MS), smooth), None),
        ((held(MS), held(2 * MS)), "1"),  # the one that moves most often
        ((held(2 * MS), held(MS)), "1"),
        ((held(250 * US),), None),  # 4 times in 1 ms is fine enough
        ((held(300 * US),), "0.3"),
        ((held(MS), lambda *_: 3.0), "1"),  # an output that never moves says nothing
        ((held(6 * MS),), None),  # three changes are too few to say anything
        ((held(5 * MS),), "5"),  # four
        # New after 0.3 and after 0.7 ms in turns
        ((lambda time_ns, _: 2.0 * (time_ns // MS) + (time_ns % MS >= 300 * US),), "0.7"),
    ],
)
def test_all_outputs_that_move_must_stand_still(
    outputs: tuple[Output, ...], held_ms: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = findings(*outputs, patch=monkeypatch)
    if held_ms is None:
        assert found == AGREE
    else:
        assert found == [("FAIL", f"its outputs stand still for steps below {held_ms} ms")]


def rough(share: float, step_ns: int) -> Output:
    """Return an output that is too large by a share of its range of 20 in steps of this length."""
    return lambda time_ns, own_ns: time_ns / MS + 20 * share * (own_ns == step_ns)


@pytest.mark.parametrize(
    ("outputs", "words"),
    [
        ((rough(0.0005, 50 * US),), None),
        ((rough(0.02, 50 * US),), "2.0% of its range between steps of 1 ms and 0.05 ms"),
        ((rough(0.02, 250 * US),), "2.0% of its range between steps of 1 ms and 0.25 ms"),
        ((rough(0.02, 250 * US), rough(0.04, 50 * US)), "out1 differs by 3.8%"),
        ((rough(-0.04, 50 * US), rough(0.02, 250 * US)), "out0 differs by 4.0%"),
        ((smooth, lambda *_: 3.0), None),
    ],
)  # fmt: skip
def test_a_course_that_follows_its_steps_is_named_with_the_worst_output(
    outputs: tuple[Output, ...], words: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = findings(*outputs, patch=monkeypatch)
    if words is None:
        assert found == AGREE
        return
    ((level, text),) = found
    assert level == "warn"
    assert words in text


def test_what_cannot_be_compared_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """A named inner step, whole numbers, texts, and steps that the FMU refuses."""
    bad = rough(0.5, 50 * US)
    assert findings(bad, patch=monkeypatch)[0][0] == "warn"
    assert findings(bad, patch=monkeypatch, inner_ns=250 * US)[0][0] == "warn"
    assert findings(bad, patch=monkeypatch, inner_ns=250 * US + 1) == []
    for other in ({"kind": "Int32"}, {"kind": "Boolean"}, {"variability": "discrete"}):
        assert findings(bad, patch=monkeypatch, **other) == AGREE  # type: ignore[arg-type]
    assert findings(bad, patch=monkeypatch, refused_ns=(50 * US,)) == AGREE
    assert findings(bad, patch=monkeypatch, refused_ns=(50 * US, 250 * US)) == []
    ((level, _),) = findings(bad, patch=monkeypatch, refused_ns=(MS,))
    assert level == "warn"
