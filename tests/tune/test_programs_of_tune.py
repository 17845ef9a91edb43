"""Programs that `axisrig tune` measures with, and the axis that it measures: nothing runs."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.tune import measure
from axisrig.bench.tools.tune.measure import Bench, Steps, at_rest, distance_step, surface_steps
from axisrig.kernel.errors import UserError

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "distance-z.toml"
BENCH = Bench(RIG, "Z", None, ())


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def run(bench: Bench, parameters: Any, blocks: Any) -> Any:
        found.update(bench=bench, parameters=dict(parameters), blocks=list(blocks))
        return SimpleNamespace(signals="signals")

    monkeypatch.setattr(measure, "_run", run)
    return found


def test_at_rest_the_axis_is_lifted_once_by_the_step(ran: dict[str, Any]) -> None:
    """200 cycles of 2 ms before and after it."""
    assert at_rest(BENCH, 0.25, 0.002) == "signals"
    assert ran["blocks"] == ["G4 0.4", "G91 G1 Z0.250000 F60", "G90", "G4 0.4"]
    assert ran["parameters"] == {}


def test_the_surface_steps_up_first_and_down_again(ran: dict[str, Any]) -> None:
    surface_steps(BENCH, 10.0, 0.5, Steps(3, 50, 0.001))
    assert ran["blocks"] == [
        "G4 0.2", "Z[DIST_CTRL ON SET_POS=10.000000]", "G4 0.2",
        "Z[DIST_CTRL SET_POS=10.500000]", "G4 0.05", "Z[DIST_CTRL SET_POS=10.000000]", "G4 0.05",
        "Z[DIST_CTRL SET_POS=10.500000]", "G4 0.05", "Z[DIST_CTRL OFF NO_MOVE]",
    ]  # fmt: skip
    own = ran["parameters"]
    assert (own["kp"], own["n_cycles"], own["i_tn"], own["d_tv"]) == (measure.PROBING_KP, 1, 0, 0)
    assert own["filter_type"] == "MOVING_AVERAGE"


def test_the_distance_steps_with_law_and_filter_of_the_list(ran: dict[str, Any]) -> None:
    law: Any = SimpleNamespace(kp=0.3, tn_s=5.0, tv_s=0.01)
    distance_step(BENCH, law, 2.0, 0.1, Steps(1, 100, 0.002))
    assert ran["blocks"][1] == "Z[DIST_CTRL ON CONST_DIST SET_DIST=2.000000]"
    assert ran["blocks"][3:] == [
        "Z[DIST_CTRL SET_DIST=2.100000]", "G4 0.2", "Z[DIST_CTRL OFF NO_MOVE]",
    ]  # fmt: skip
    own = ran["parameters"]
    assert (own["kp"], own["i_tn"], own["d_tv"]) == (0.3, 5.0, 0.01)
    assert "n_cycles" not in own
    assert own["v_max"] == measure.WITHOUT_LIMITS["v_max"]


def test_limits_of_a_measuring_run_clamp_and_its_words_come_last() -> None:
    """A user's own word for a parameter does not spoil what is measured with."""
    bench = Bench(RIG, "Z", None, ("set:Z.kenngr.distc.kp=0.9", "plc:V.E.A=1"))
    plain = bench.settings()
    assert plain.rig.distance.limiter == "slope"
    own = bench.settings({"kp": 0.15})
    assert own.rig.distance.limiter == "clamp"
    values = [settings.axis["Z"].get("kenngr.distc.kp") for settings in (plain, own)]
    assert [float(value) for value in values] == [0.9, 0.15]
    assert own.external["A"] == plain.external["A"] == 1.0


def test_only_an_axis_that_is_released_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    def rig(*released: str, axes: str = "XZ", is_paced: bool = False) -> None:
        axis = {name: SimpleNamespace(flag=lambda _, n=name: n in released) for name in axes}
        settings = SimpleNamespace(axis=axis)
        monkeypatch.setattr(Bench, "settings", lambda *_: settings)
        monkeypatch.setattr(measure, "is_paced", lambda _: is_paced)

    rig("Z")
    assert measure.choose(RIG, None, "V.E.S", ["a"]) == Bench(RIG, "Z", "V.E.S", ("a",))
    assert measure.choose(RIG, "Z", None, []).axis == "Z"
    for axis, message in (("X", "of the axis is not released"), ("Y", "has no such axis")):
        with pytest.raises(UserError, match=message) as refused:
            measure.choose(RIG, axis, None, [])
        assert ("lr_param.distance_control_on (P-AXIS-00328)" in str(refused.value.hint)) is (
            axis == "X"
        )
        assert (refused.value.value, refused.value.allowed is not None) == (axis, axis == "Y")
    rig("X", "Z")
    assert measure.choose(RIG, "X", None, []).axis == "X"
    with pytest.raises(UserError, match="several axes have distance control"):
        measure.choose(RIG, None, None, [])
    rig()
    with pytest.raises(UserError, match="no axis of the rig has distance control"):
        measure.choose(RIG, None, None, [])
    rig("Z", is_paced=True)
    with pytest.raises(UserError, match="a real CAN interface"):
        measure.choose(RIG, "Z", None, [])


def test_what_is_noted_of_a_cycle_is_of_its_own_axis() -> None:
    def control(sensor_mm: float | None, pos: float | None, dist: float | None) -> Any:
        own = SimpleNamespace(set_pos_mm=pos, set_dist_mm=dist, offset_mm=7.0)
        return SimpleNamespace(sensor_mm=sensor_mm, control=own)

    links = [SimpleNamespace(name=name, set_mm=mm, actual_mm=mm + 0.5)
             for name, mm in (("X", 1.0), ("Z", 2.0))]  # fmt: skip

    def noted(is_distance: bool) -> list[list[float]]:
        log = measure._Log("Z", is_distance)
        for one in (control(None, 1.0, 2.0), control(-3.0, 4.0, 5.0), control(-3.0, None, None)):
            axes = {"X": control(9.0, 9.0, 9.0), "Z": one}
            log(SimpleNamespace(distance=SimpleNamespace(axes=axes), links=links))  # type: ignore[arg-type]
        found = log.signals()
        rows = (found.wanted_mm, found.offset_mm, found.set_mm, found.actual_mm, found.distance_mm)
        return [[float(value) for value in row] for row in rows]

    for is_distance, wanted in ((False, 4.0), (True, 5.0)):
        first, *others = noted(is_distance)
        assert first[0] == wanted
        assert first[1] != first[1]  # nothing is wanted
        assert others == [[7.0, 7.0], [2.0, 2.0], [2.5, 2.5], [3.0, 3.0]]
