"""Values of a live state: latches, distance controls; and the pipe that it goes through."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.live import states
from axisrig.bench.machine.live.pipe import CAPACITY, Inlet, Outlet


@pytest.mark.parametrize(
    ("has_latched", "is_armed", "is_probing", "word"),
    [(True, True, True, "edge stored"), (False, True, True, "armed"),
     (False, False, True, "ordered"), (False, False, False, "off")],
)  # fmt: skip
def test_a_touch_probe_is_shown_with_its_last_stage(
    has_latched: bool, is_armed: bool, is_probing: bool, word: str
) -> None:
    link: Any = SimpleNamespace(has_latched=has_latched, is_armed=is_armed, is_probing=is_probing)
    assert states._touch_probe(link) == word


def test_the_last_run_of_an_axis_that_has_a_value_counts() -> None:
    def run(block: str, at_ns: int | None, **latched: float) -> Any:
        return SimpleNamespace(block=block, signal_ns=at_ns, end_ns=99, latched_mm=latched)

    records = [run("N10", 5, Z=1.0), run("N20", 6, Z=2.0, X=3.0), run("N30", None, Y=4.0)]
    machine: Any = SimpleNamespace(channel=SimpleNamespace(records=records))
    assert states._last_latch(machine, "Z") == {"position": 2.0, "block": "N20", "time_ns": 6}
    assert states._last_latch(machine, "Y") == {"position": 4.0, "block": "N30", "time_ns": 99}
    assert states._last_latch(machine, "W") is None
    many = [run("N1", 1, Z=0.5), *(run("N2", 2) for _ in range(states._RUNS_LOOKED_AT))]
    machine.channel.records = many
    assert states._last_latch(machine, "Z") is None
    machine.channel.records = many[:-1]
    assert states._last_latch(machine, "Z") is not None


def test_a_distance_control_is_shown_with_its_own_set_value(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(states, "is_rotary", lambda _settings, name: name in ("C", "channel"))
    monkeypatch.setattr(states, "source_word", lambda sensor: f"of {sensor}")
    control = SimpleNamespace(
        state=states.DistanceState.ACTIVE_CONST_DIST, source=SimpleNamespace(name="PLC"),
        is_dry_run=True, settings=SimpleNamespace(sensor_sign=-1.0), distance_mm=2.0,
        set_dist_mm=3.0, set_pos_mm=4.0, filtered_mm=5.0, error_mm=6.0, offset_mm=7.0,
    )  # fmt: skip
    found: Any = SimpleNamespace(control=control, sensor_mm=1.5, sensor="s", is_held=False)
    machine: Any = SimpleNamespace(settings=None)
    shown = states._distance(machine, "C", found)
    assert shown == {
        "axis": "C", "unit": "°", "state": "active const dist", "source": "PLC", "sensor": "of s",
        "is_held": False, "is_dry_run": True, "reading": -1.5, "distance": 2.0,
        "set_name": "SET_DIST", "set": 3.0, "filtered": 5.0, "error": 6.0, "offset": 7.0,
    }  # fmt: skip
    control.state, found.sensor_mm = states.DistanceState.ACTIVE, None
    before = states._distance(machine, "Z", found)
    assert (before["set_name"], before["set"], before["state"]) == ("SET_POS", 4.0, "active")
    assert (before["reading"], before["distance"], before["unit"]) == (None, None, "mm")
    assert states._distance(machine, "channel", found)["unit"] == "mm"  # of a tool


def test_a_state_may_fill_the_pipe(tmp_path: Path) -> None:
    inlet = Inlet(tmp_path / "pipe")
    outlet = Outlet(tmp_path / "pipe")
    for size, is_there in ((CAPACITY, True), (CAPACITY + 1, False), (0, True)):
        inlet.ask()
        assert outlet.is_asked
        outlet.put(b"x" * size)
        assert not outlet.is_asked
        found = inlet.take()
        assert found == (b"x" * size if is_there else None)
        assert inlet.take() is None
    inlet.close()
