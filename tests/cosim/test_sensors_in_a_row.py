"""Sensors whose FMUs take several steps in one call, by hand: what each step is given and gives."""

from collections.abc import Callable, Sequence
from math import sqrt
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from tests.cosim.fmus_by_hand import Fmu
from tests.cosim.test_edges_of_a_probe import INPUTS, Locating, probe_of

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.plant import distance as distance_module
from axisrig.kernel.cosim.plant import edges as edges_module
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.probe import SPEED_GAIN_M_S2
from axisrig.kernel.time.clock import MS, US, S, TimeNs


class Rows:
    """Steps in a row of an FMU by hand; refused_ns: the end of the step that fails."""

    refused_ns: ClassVar[TimeNs | None] = None
    given: ClassVar[list[list[float]]] = []

    def __init__(self, slave: Any, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self._slave, self._inputs, self._outputs = slave, inputs, outputs

    def take(self, ends_ns: Sequence[TimeNs], given: Sequence[float]) -> list[list[float]]:
        width, rows = len(self._inputs), []
        for number, end_ns in enumerate(ends_ns):
            self.given.append(list(given[number * width : (number + 1) * width]))
            if end_ns == self.refused_ns:
                break
            self._slave.time_ns = end_ns
            rows.append([self._slave.value(name) for name in self._outputs])
        return rows

    def refuse(self, end_ns: TimeNs) -> None:
        raise PlantError(self._slave.name, end_ns, "refused")


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> type[Rows]:
    """Every FMU takes steps in a row."""
    for module in (distance_module, edges_module):
        monkeypatch.setattr(module, "StepsInARow", Rows)
        monkeypatch.setattr(module, "offers_steps", lambda _slave: True)
        monkeypatch.setattr(
            module, "plain_references", lambda found: [n for each in found for n in each._names]
        )
    monkeypatch.setattr(Rows, "refused_ns", None)
    monkeypatch.setattr(Rows, "given", [])
    return Rows


# Distance sensors


def sensor_of(**outputs: Any) -> tuple[Fmu, PlantDistance, Any]:
    fmu = Fmu(*INPUTS, **outputs)
    axis = SimpleNamespace(motion=[0.5, 0.0], walked=[], tick=(0.0,) * 4)
    return fmu, PlantDistance(fmu.roles, {"z": axis}), axis  # type: ignore[dict-item]


ENDS_NS = [250 * US, 500 * US, 600 * US]
WALKED = [[0.5, 0.0], [0.6, 1.0], [0.75, 2.0], [0.8, 3.0]]


@pytest.mark.parametrize("has_true", [True, False])
def test_each_step_of_a_walk_has_the_motion_at_both_its_ends(
    rows: type[Rows], has_true: bool
) -> None:
    outputs: dict[str, Callable[[int], float]] = {"distance": lambda ns: ns * 1e-6}
    if has_true:
        outputs["distance_true"] = lambda ns: ns * 2e-6
    fmu, sensor, axis = sensor_of(**outputs)
    sensor.start(0)
    assert sensor.walks
    axis.walked = WALKED
    sensor.walk(0, ENDS_NS)
    begins = [0, *ENDS_NS[:-1]]
    assert rows.given == [
        pytest.approx([begin * 1e-9, (end - begin) * 1e-9, *WALKED[n][:2], *WALKED[n + 1][:2]])
        for n, (begin, end) in enumerate(zip(begins, ENDS_NS, strict=True))
    ]
    fmu.outputs = {}  # what the row has given is not read once more
    sensor.look()
    expected = (0.6, 1.2 if has_true else None, True, False)
    assert sensor.reported_at(600 * US) == pytest.approx(expected)
    assert sensor.distance_m == pytest.approx(0.6)
    with pytest.raises(PlantError):
        sensor.reported_at(-1)


def test_after_a_step_alone_the_fmu_is_asked_again(rows: type[Rows]) -> None:
    fmu, sensor, axis = sensor_of(distance=lambda ns: ns * 1e-6)
    sensor.start(0)
    axis.walked = WALKED
    sensor.walk(0, ENDS_NS)
    sensor.look()
    axis.tick = (0.8, 3.0, 0.9, 4.0)
    sensor.step(600 * US, 700 * US)
    sensor.look()
    assert sensor.distance_m == pytest.approx(0.7)
    assert [fmu.inputs[name] for name in INPUTS] == pytest.approx([6e-4, 1e-4, 0.8, 3.0, 0.9, 4.0])


@pytest.mark.parametrize("at", range(len(ENDS_NS)))
def test_the_step_of_a_walk_that_fails_is_named_by_its_end(rows: type[Rows], at: int) -> None:
    _, sensor, axis = sensor_of(distance=0.0)
    sensor.start(0)
    axis.walked = WALKED
    rows.refused_ns = ENDS_NS[at]
    with pytest.raises(PlantError, match=rf"t = {ENDS_NS[at] / MS:.6f} ms: refused"):
        sensor.walk(0, ENDS_NS)


# Probes


@pytest.fixture
def touching() -> Locating:
    """Up at 30 us, down at 130 us; 1 mm of clearance in the first 100 us and 1.8 mm then."""
    found = Locating((30,), (130,), level=0.0)
    found.outputs["clearance"] = lambda ns: 1e-3 if ns <= 100 * US else 1.8e-3
    found.function = lambda _name, _signature: None  # type: ignore[method-assign]
    return found


def test_edges_of_a_row_are_those_of_its_step(rows: type[Rows], touching: Locating) -> None:
    probe = probe_of(touching)
    for begin, edges in ((0, [(30, True)]), (100, [(130, False)]), (200, [])):
        known = len(probe.signal.edges)
        assert probe.step(begin * US, (begin + 100) * US) == len(edges)
        probe.accept(100 * US)
        assert probe.signal.edges[known:] == [(at * US, is_high) for at, is_high in edges]
    assert rows.given[1] == pytest.approx([100e-6, 100e-6, 1.0, 2.0, 3.0, 4.0])


def test_a_step_that_fails_is_named_by_its_end(rows: type[Rows], touching: Locating) -> None:
    probe = probe_of(touching)
    probe.step(0, 100 * US)
    rows.refused_ns = 200 * US
    with pytest.raises(PlantError, match=r"t = 0\.200000 ms: refused"):
        probe.step(100 * US, 200 * US)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_probe_that_rests_has_the_clearance_of_now_and_not_of_its_last_step(
    rows: type[Rows], touching: Locating, sign: float
) -> None:
    """0.8 mm of 1 mm are used up; from where the axis is then there are 1.8 mm: sqrt(2 s/a)."""
    touching.outputs["falling_count"] = 0.0
    probe = probe_of(touching)
    probe.step(0, 100 * US)
    probe.accept(100 * US)
    (axis,) = probe.sources
    axis.motion[0] = sign * 0.8e-3
    free_ns = probe.look_ahead(20 * MS, 20 * MS) - 20 * MS
    assert touching.time_ns == 20 * MS
    assert free_ns == pytest.approx(sqrt(2 * 1.8e-3 / SPEED_GAIN_M_S2) * S, abs=2)
    way = [touching.inputs[name] for name in INPUTS]
    assert way == pytest.approx([100e-6, 20e-3 - 100e-6, *(sign * 0.8e-3, 0.0) * 2])
    assert len(rows.given) == 1  # at rest it is stepped alone


def test_an_edge_while_a_probe_rests_is_an_error(rows: type[Rows], touching: Locating) -> None:
    """By its clearance there can be none."""
    touching.outputs["falling_count"] = lambda ns: float(ns > 10 * MS)
    probe = probe_of(touching)
    probe.step(0, 100 * US)
    probe.accept(100 * US)
    (axis,) = probe.sources
    axis.motion[0] = 0.8e-3
    with pytest.raises(PlantError, match="its clearance said that none can be"):
        probe.look_ahead(20 * MS, 20 * MS)
