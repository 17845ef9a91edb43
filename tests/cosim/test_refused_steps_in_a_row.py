"""Axes whose FMU takes several steps in one call, by hand: what is kept, and which step is refused.

The FMU here has the outputs of an axis as functions of its time, and refuses the step that ends
at an instant.
"""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant import axis as axis_module
from axisrig.kernel.cosim.plant.axis import FINE_NS, PlantAxis
from axisrig.kernel.cosim.plant.outputs import AXIS_OUTPUTS
from axisrig.kernel.time.clock import MS, TimeNs

MOTION = AXIS_OUTPUTS[:5]
ENDS_NS = [1 * MS, 3 * MS, 4 * MS]


class Rows:
    """Steps in a row of an FMU by hand; refused_ns: the end of the step that fails."""

    refused_ns: ClassVar[TimeNs | None] = None
    calls: ClassVar[list[list[TimeNs]]] = []

    def __init__(self, slave: Any, outputs: Sequence[Callable[[int], float]]) -> None:
        self._slave, self._outputs = slave, outputs

    def take(self, ends_ns: Sequence[TimeNs]) -> list[list[float]]:
        self.calls.append(list(ends_ns))
        rows = []
        for end_ns in ends_ns:
            if end_ns == self.refused_ns:
                break
            self._slave.time_ns = end_ns
            rows.append([output(end_ns) for output in self._outputs])
        return rows

    def refuse(self, end_ns: TimeNs) -> None:
        raise PlantError(self._slave.name, end_ns, "refused")


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> type[Rows]:
    """Every FMU takes steps in a row."""
    monkeypatch.setattr(axis_module, "StepsInARow", Rows)
    monkeypatch.setattr(axis_module, "offers_steps", lambda _slave: True)
    monkeypatch.setattr(
        axis_module, "plain_references", lambda found: [o for each in found for o in each.outputs]
    )
    monkeypatch.setattr(Rows, "refused_ns", None)
    monkeypatch.setattr(Rows, "calls", [])
    return Rows


def ramp(start_m: float) -> dict[str, Callable[[int], float]]:
    """An axis at 1 m/s; its motor is 1 mm ahead, its demand 2 mm."""
    return {
        name: (lambda _t: 1.0) if "velocity" in name
        else (lambda t, off=off: start_m + off + t * 1e-9)
        for name, off in zip(MOTION, (0.0, 0.0, 1e-3, 0.0, 2e-3), strict=True)
    }  # fmt: skip


def axes(*outputs: dict[str, Any]) -> list[PlantAxis]:
    """Axes on one FMU, each with its outputs."""
    one = Fmu(*RAMP)
    found: list[PlantAxis] = []
    for each in outputs:
        fmu = Fmu(*RAMP, **each)
        roles = fmu.roles
        roles.slave, fmu.outputs = one, each
        make = roles.exchange

        def exchange(names: Any, make: Any = make, each: Any = each) -> Any:
            values = make(names)
            values.outputs = [each[name] for name in names if name in each]
            values.read = lambda: values.values.__setitem__(
                slice(None), [each[name](one.time_ns) if name in each else 0.0 for name in names]
            )
            return values

        roles.exchange = exchange
        found.append(PlantAxis(roles, lambda _ns: None, found[0] if found else None))
    for axis in found:
        axis.start(0)
    return found


@pytest.mark.parametrize("at", range(len(ENDS_NS)))
@pytest.mark.parametrize("count", [1, 2])
def test_the_step_that_is_refused_is_named_by_its_end_and_those_before_are_kept(
    rows: type[Rows], at: int, count: int
) -> None:
    found = axes(*(ramp(float(number)) for number in range(count)))
    rows.refused_ns = ENDS_NS[at]
    with pytest.raises(PlantError, match=rf"t = {ENDS_NS[at] / MS:.1f}0* ms: refused"):
        found[0].walk(ENDS_NS)
    last_ns = ENDS_NS[at - 1] if at else 0
    for number, axis in enumerate(found):
        assert axis.position_m() == pytest.approx(number + last_ns * 1e-9)
        assert axis.motion_at(last_ns) == axis.motion
        with pytest.raises(PlantError):
            axis.motion_at(ENDS_NS[at])


def test_each_axis_of_an_fmu_has_its_own_outputs_of_a_row(rows: type[Rows]) -> None:
    """The second one reports a force besides."""
    first, second = axes(ramp(0.0), ramp(5.0) | {"force": lambda t: t * 1e-6})
    first.walk(ENDS_NS)
    assert rows.calls == [ENDS_NS]
    for axis, start_m, forces in ((first, 0.0, (0.0, 0.0)), (second, 5.0, (3.0, 4.0))):
        ends = [(start_m + t * 1e-9, 1.0) for t in (3 * MS, 4 * MS)]
        assert [row[0] for row in axis.walked] == pytest.approx(
            [start_m + t * 1e-9 for t in (0, *ENDS_NS)]
        )
        assert axis.tick == pytest.approx((*ends[0], *ends[1]))
        assert axis.motor_position_m() == pytest.approx(start_m + 5e-3)
        assert axis.motor_velocity_m_s() == 1.0
        assert axis.demand_position_m() == pytest.approx(start_m + 6e-3)
        assert axis.walked[2][5] == forces[0]
        assert axis.walked[3][5] == forces[1]
    assert (first.force_n(), second.force_n()) == (None, 4.0)
    second.walk(ENDS_NS)  # the axis beside has stepped the FMU of both
    assert rows.calls == [ENDS_NS]


@pytest.mark.parametrize(
    ("since_ms", "until_ms", "peak_n"),
    [(0, 6, 7.0), (4, 6, 5.0), (5, 6, 5.0), (6, 6, 0.0), (0, 1, 0.0), (0, 3, 7.0)],
)
def test_the_last_contact_of_a_row_counts(
    rows: type[Rows], since_ms: int, until_ms: int, peak_n: float
) -> None:
    """Pulses of 7 N at 2 ms and of 5 N at 5 ms; the axis does not report its stop's face."""
    forces_n = {2 * MS: 7.0, 5 * MS: 5.0}
    pulses = {"force": lambda _t: 0.0, "stop_force": lambda t: forces_n.get(t, 0.0)}
    (axis,) = axes(ramp(0.0) | pulses)
    axis.walk([k * MS for k in range(1, 7)])
    assert rows.calls == [[k * MS for k in range(1, 7)]]
    assert axis.stop_force_peak_n(since_ms * MS, until_ms * MS) == pytest.approx(peak_n)


def test_where_a_stop_can_be_touched_the_steps_of_a_row_are_fine_ones(rows: type[Rows]) -> None:
    """1 m/s towards a stop 1 mm ahead: the first step of 1 ms is near it; away from it none is."""
    face = {"force": lambda _t: 0.0, "stop_force": lambda _t: 0.0}
    (near,) = axes(ramp(0.0) | face | {"stop_face": lambda _t: 1e-3})
    near.walk([MS])
    assert rows.calls == [[*range(FINE_NS, MS, FINE_NS), MS]]
    assert near.tick == pytest.approx((0.0, 1.0, 1e-3, 1.0))
    assert len(near.walked) == 2
    rows.calls.clear()
    (far,) = axes(ramp(0.0) | face | {"stop_face": lambda _t: 1.0})
    far.walk(ENDS_NS)
    assert rows.calls == [ENDS_NS]
