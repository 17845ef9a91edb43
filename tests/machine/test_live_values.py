"""Values of a live state: latches, distance controls; and the pipe that it goes through."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import PacedScheduler, Pacing
from axisrig.bench.machine.live import states
from axisrig.bench.machine.live.pipe import CAPACITY, Inlet, Outlet
from axisrig.kernel.channel import ChannelState
from axisrig.kernel.nc import canon


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


# --- a whole state


def link(name: str, number: float, **more: Any) -> Any:
    given = {"name": name, "set_mm": number, "actual_mm": number + 0.1, "lag_mm": number + 0.2,
             "state_name": "OPERATION_ENABLED", "is_actuated": number > 1.5, "has_latched": False,
             "is_armed": True, "is_probing": True}  # fmt: skip
    return SimpleNamespace(**given | more)


def signal(level: bool, *edges: tuple[int, bool]) -> Any:
    return SimpleNamespace(signal=SimpleNamespace(level=level, edges=list(edges)))


def machine_of(state: ChannelState = ChannelState.RUNNING) -> Any:
    """X is outside, C turns and measures; two probes, of which one has had edges."""
    block = SimpleNamespace(place="part.nc line 7", text="N70 G1 X1")
    execution = SimpleNamespace(
        begun=canon.ExactStop(block), head=None, is_busy=lambda: True  # type: ignore[arg-type]
    )  # fmt: skip
    channel = SimpleNamespace(
        state=state, execution=execution, path=SimpleNamespace(is_held=True),
        links=[link("X", 1.0), link("C", 2.0, has_latched=True)],
        single=SimpleNamespace(measuring_state={"C": "EDGE_AWAITED"}.get),
        records=[], alarms=[f"alarm {n}" for n in range(4)],
        further_alarms=[f"further {n}" for n in range(3)],
        distance=SimpleNamespace(axes={}, channel=None),
    )  # fmt: skip
    parts = [SimpleNamespace(shown=lambda n=n: [{"segment": n}]) for n in (1, 2)]
    return SimpleNamespace(
        channel=channel, settings=None, outside=frozenset("X"), installed=parts,
        scheduler=SimpleNamespace(now_ns=77),
        plant=SimpleNamespace(probes={"p": signal(True, (3, True), (5, False), (9, True)),
                                      "q": signal(False)}),
        messages=[SimpleNamespace(shown=f"text {n}") for n in range(7)],
    )  # fmt: skip


@pytest.fixture
def turning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(states, "is_rotary", lambda _settings, name: name == "C")


@pytest.mark.usefixtures("turning")
def test_a_state_has_each_value_of_its_own_axis_and_probe() -> None:
    shown = states.state_of(machine_of())
    assert (shown["time_ns"], shown["channel"], shown["is_held"]) == (77, "running", True)
    assert (shown["block"], shown["block_text"]) == ("part.nc line 7", "N70 G1 X1")
    assert shown["waits_for"] == "the axes in their exact-stop windows"
    common = {"drive": "operation enabled", "latch": None}
    assert shown["axes"] == [
        {"axis": "X", "unit": "mm", "is_outside": True, "set": 1.0, "actual": 1.1, "lag": 1.2,
         "measuring": None, "input": False, "touch_probe": "armed", **common},
        {"axis": "C", "unit": "°", "is_outside": False, "set": 2.0, "actual": 2.1, "lag": 2.2,
         "measuring": "edge awaited", "input": True, "touch_probe": "edge stored", **common},
    ]  # fmt: skip
    assert shown["probes"] == [
        {"probe": "p", "level": True, "edges": 3, "edge_ns": 9},
        {"probe": "q", "level": False, "edges": 0, "edge_ns": None},
    ]
    assert shown["bus"] == [{"segment": 1}, {"segment": 2}]
    assert shown["real_time"] is None


@pytest.mark.usefixtures("turning")
def test_the_last_five_alarms_and_messages_are_shown() -> None:
    shown = states.state_of(machine_of())
    assert shown["alarms"] == ["alarm 2", "alarm 3", "further 0", "further 1", "further 2"]
    assert shown["messages"] == [f"text {n}" for n in (2, 3, 4, 5, 6)]


@pytest.mark.usefixtures("turning")
def test_while_the_drives_start_no_position_is_known_and_no_block_at_work() -> None:
    shown = states.state_of(machine_of(ChannelState.STARTING))
    assert [[axis[name] for name in ("set", "actual", "lag")] for axis in shown["axes"]] == [
        [None] * 3
    ] * 2
    assert (shown["block"], shown["waits_for"]) == (None, "the drives have not started")
    powering = states.state_of(machine_of(ChannelState.POWERING))
    assert [axis["set"] for axis in powering["axes"]] == [1.0, 2.0]


def test_how_real_time_is_kept_is_that_of_the_last_syncs() -> None:
    """Late by more than 100 us: two of four; the latest by 350 us."""
    clock = PacedScheduler(SimpleNamespace(monotonic_ns=None, pause=None),  # type: ignore[arg-type]
                           Pacing(0), Deadlines(100_000))  # fmt: skip
    for late_ns in (50_000, 350_000, 100_000, 100_001):
        clock.deadlines.sync_sent(0, late_ns)
    clock.deadlines.slipped_ns, clock.deadlines.send_errors = 2_500_000, 3
    machine: Any = SimpleNamespace(scheduler=clock)
    assert states._real_time(machine) == {
        "syncs": 4, "looked_at": 4, "late": 2, "late_us": 100.0, "worst_us": 350.0,
        "slipped_ms": 2.5, "send_errors": 3,
    }  # fmt: skip


@pytest.mark.parametrize("more", [0, 1, 40])
def test_of_a_long_run_the_last_syncs_alone_say_how_real_time_is_kept(more: int) -> None:
    """Each of the first ones was late by 5 ms, of the last ones every fifth by 300 us."""
    clock = PacedScheduler(SimpleNamespace(monotonic_ns=None, pause=None),  # type: ignore[arg-type]
                           Pacing(0), Deadlines(100_000))  # fmt: skip
    for _ in range(more):
        clock.deadlines.sync_sent(0, 5_000_000)
    for number in range(states.SYNCS_LOOKED_AT):
        clock.deadlines.sync_sent(0, 300_000 if number % 5 == 0 else 0)
    machine: Any = SimpleNamespace(scheduler=clock)
    shown = states._real_time(machine)
    assert shown is not None
    assert shown["syncs"] == states.SYNCS_LOOKED_AT + more
    assert shown["looked_at"] == states.SYNCS_LOOKED_AT
    assert (shown["late"], shown["worst_us"]) == (states.SYNCS_LOOKED_AT // 5, 300.0)


def test_a_long_text_is_shown_from_its_begin_on() -> None:
    """Also within lists and tables; numbers and names are as they are."""
    long = "begin" + "x" * states.TEXT_MAX + "end"
    shown = json.loads(states.as_json({"a": long, "b": [long, {"c": long}], 5: (1, -0.5, None)}))
    cut = long[: states.TEXT_MAX]
    assert shown == {"a": cut, "b": [cut, {"c": cut}], "5": [1, -0.5, None]}
    whole = "y" * states.TEXT_MAX
    assert json.loads(states.as_json({"a": whole})) == {"a": whole}


@pytest.mark.parametrize("value", [float("inf"), float("-inf"), float("nan")])
def test_what_is_no_finite_number_is_null_wherever_it_stands(value: float) -> None:
    assert json.loads(states.as_json({"a": value, "b": [value], "c": {"d": value}})) == {
        "a": None, "b": [None], "c": {"d": None}
    }  # fmt: skip


@pytest.mark.interpreted
@pytest.mark.usefixtures("turning")
def test_a_state_is_sent_when_it_is_asked_for_and_is_that_of_the_machine() -> None:
    """What is known of the run is beside it, and says nothing of the machine itself."""
    sent: list[bytes] = []
    pipe: Any = SimpleNamespace(is_asked=False, put=sent.append)
    shows = states.LiveStates(pipe, {"run": "r1", "time_ns": -1, "channel": "none"})
    shows(machine_of())
    assert sent == []
    pipe.is_asked = True
    shows(machine_of())
    shows(machine_of(ChannelState.POWERING))
    found = [json.loads(state) for state in sent]
    assert [(each["run"], each["time_ns"], each["channel"]) for each in found] == [
        ("r1", 77, "running"), ("r1", 77, "powering")
    ]  # fmt: skip
