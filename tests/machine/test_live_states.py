"""What a run shows of itself while it lasts: the pipe, the state, and that nothing else changes."""

import json
import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from tests.live_states import ABOUT, AXIS, DISTANCE, SEGMENT, state

from axisrig.bench.bus.can.load import LoadMeter
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.machine.live import states
from axisrig.bench.machine.live.pipe import CAPACITY, Inlet, Outlet
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS, US

TESTPLANS = Path(__file__).parents[2] / "testplans"


@pytest.fixture
def inlet(tmp_path: Path) -> Iterator[Inlet]:
    with closing(Inlet(tmp_path / "pipe")) as inlet:
        yield inlet


@pytest.fixture
def outlet(inlet: Inlet, tmp_path: Path) -> Outlet:
    return Outlet(tmp_path / "pipe")


def test_a_state_is_wanted_once_for_each_question(inlet: Inlet, outlet: Outlet) -> None:
    assert not outlet.is_asked
    inlet.ask()
    inlet.ask()
    assert outlet.is_asked
    outlet.put(b"one")
    assert not outlet.is_asked
    assert [inlet.take(), inlet.take()] == [b"one", None]


def test_the_newest_state_wins_whether_anybody_has_read_or_not(
    inlet: Inlet, outlet: Outlet
) -> None:
    for number in range(1000):
        outlet.put(b"%d" % number)
    assert inlet.take() == b"999"
    outlet.put(b"a longer one")
    outlet.put(b"short")
    assert inlet.take() == b"short"


def test_a_run_that_comes_later_goes_on_in_the_same_pipe(
    inlet: Inlet, outlet: Outlet, tmp_path: Path
) -> None:
    outlet.put(b"first run")
    assert inlet.take() == b"first run"
    Outlet(tmp_path / "pipe").put(b"second run")
    assert inlet.take() == b"second run"


def test_what_is_half_written_or_too_large_is_no_state(
    inlet: Inlet, outlet: Outlet, tmp_path: Path
) -> None:
    outlet.put(b"good")
    assert inlet.take() == b"good"
    inlet.ask()
    outlet.put(bytes(CAPACITY + 1))
    assert not outlet.is_asked
    assert inlet.take() is None
    outlet.put(b"whole")
    with (tmp_path / "pipe").open("r+b") as file:  # a process that died in the middle of the next
        file.seek(struct.calcsize("<?xxxxxxxQII"))
        file.write(b"wh*")
    assert inlet.take() is None
    outlet.put(b"again")
    assert inlet.take() == b"again"


def test_strict_json_whatever_a_machine_has() -> None:
    text = states.as_json({"a": float("nan"), "b": [float("inf"), 1.5, True], "c": "ä" * 1000})
    assert json.loads(text) == {"a": None, "b": [None, 1.5, True], "c": "ä" * states.TEXT_MAX}
    assert b"\n" not in text


def test_the_load_now_is_that_of_the_whole_windows_before() -> None:
    """Frames of 111 us in ms 0 to 3 and 222 us in each of the 100 ms after: 22.2 %."""
    meter = LoadMeter(1_000_000)
    for number in range(104):
        begin = number * MS + 10 * US
        length = (222 if number > 3 else 111) * US
        meter.passed.append((begin, begin + length, length // US, 0x80, False, 0))
    meter.count_error()
    now = meter.now(104 * MS + 500 * US, 100 * MS)
    assert (now.frames, now.error_frames, now.busy_share) == (104, 1, pytest.approx(0.222))
    assert meter.now(2 * MS, 100 * MS).busy_share == pytest.approx(0.111)
    assert LoadMeter(1_000_000).now(0, 100 * MS).busy_share == 0.0


def test_the_load_now_of_a_long_run_is_that_of_its_last_windows() -> None:
    """Five seconds with 111 us in each ms, then 0.1 s with 222 us: 22.2 %."""
    meter = LoadMeter(1_000_000)
    for number in range(5100):
        begin, length = number * MS, (111 if number < 5000 else 222) * US
        meter.passed.append((begin, begin + length, length // US, 0x80, False, 0))
        if number % 500 == 499:
            meter.settle()
    assert meter.now(5100 * MS, 100 * MS).busy_share == pytest.approx(0.222)
    assert meter.now(5100 * MS, 100 * MS).frames == 5100


def test_the_latest_lateness_is_that_of_the_last_syncs() -> None:
    kept = Deadlines(100 * US)
    for number in range(9):
        kept.sync_sent(number * MS, number * MS + number * US)
    assert list(kept.latest_ns(3)) == [6 * US, 7 * US, 8 * US]


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    """What a machine with a probe and distance control shows before it has run."""
    table, files = read_rig(TESTPLANS / "rigs/distance-z-probe.toml")
    program = read_program(TESTPLANS / "programs/meas1.nc", tuple(table.axis))
    machine = Machine(read_settings(table, files, []), program)
    try:
        shown: dict[str, Any] = json.loads(states.as_json(states.state_of(machine)))
    finally:
        machine.close()
    return shown


def test_before_the_first_cycle_nothing_is_known_of_the_axes(found: dict[str, Any]) -> None:
    assert (found["channel"], found["block"], found["time_ns"]) == ("starting", None, 0)
    assert found["waits_for"] == "the drives have not started"
    (axis,) = found["axes"]
    assert [axis[name] for name in ("set", "actual", "lag", "latch")] == [None] * 4
    assert [one["frames"] for one in found["bus"]] == [0]


def test_what_is_shown_has_the_form_that_page_and_terminal_read(found: dict[str, Any]) -> None:
    known = state(distance=[DISTANCE])
    assert {*ABOUT, *found} == known.keys()
    for name, one in (("axes", AXIS), ("distance", DISTANCE), ("bus", SEGMENT)):
        assert [part.keys() for part in found[name]] == [one.keys()], name
    assert [probe.keys() for probe in found["probes"]] == [known["probes"][0].keys()]
    assert found["real_time"] is None


def _case(plan: str, name: str) -> Case:
    return next(case for case in read_plan(TESTPLANS / plan).cases if case.case == name)


def _run(case: Case, folder: Path, live: Path | None) -> tuple[Any, dict[str, bytes]]:
    folder.mkdir()
    files = RunFiles([folder / "a.blf", folder / "a.pcap"], folder / "a.parquet", live=live)
    result = run_case(case, files)
    assert result.series is not None
    result.series.save(folder / "a.parquet")
    return result, {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


Look = Callable[[states.LiveStates, Machine], None]


@pytest.mark.parametrize(
    ("plan", "name"),
    [
        ("latch_accuracy.csv", "latch-pdo-lost"),
        pytest.param("latch_accuracy.csv", "f3000", marks=pytest.mark.long),
        pytest.param("distance_control.csv", "p-2-plain-above", marks=pytest.mark.long),
        pytest.param("fixed_stop_gantry.csv", "in-line-stiff", marks=pytest.mark.long),
    ],
)
def test_a_run_with_a_state_after_every_cycle_is_the_run_without(
    plan: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case, pipe, seen = _case(plan, name), tmp_path / "pipe", list[dict[str, Any]]()
    before: Look = states.LiveStates.__call__
    with closing(Inlet(pipe)) as inlet:

        def asked(self: states.LiveStates, machine: Machine) -> None:
            inlet.ask()
            before(self, machine)
            text = inlet.take()
            assert text is not None
            seen.append(json.loads(text))

        without, its_files = _run(case, tmp_path / "without", None)
        monkeypatch.setattr(states.LiveStates, "__call__", asked)
        shown, files = _run(case, tmp_path / "with", pipe)
    assert without.frame_log_sha256 == shown.frame_log_sha256 != ""
    assert (without.facts, without.checks, without.verdict) == (
        *(shown.facts, shown.checks, shown.verdict),
    )
    assert files == its_files
    times = [one["time_ns"] for one in seen]
    assert times == sorted(set(times))
    assert len(seen) >= shown.sim_s * 1000 / 2  # periods of 1 or 2 ms
    assert seen[-1]["run"] == case.run
    assert {one["channel"] for one in seen} >= {"starting", "powering"}


@pytest.mark.long
def test_the_states_of_a_run_are_those_that_it_leaves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Positions against the trace, the edge and its latch against the facts of the run."""
    case, pipe, seen = _case("latch_accuracy.csv", "f3000"), tmp_path / "pipe", list[Any]()
    before: Look = states.LiveStates.__call__
    with closing(Inlet(pipe)) as inlet:

        def asked(self: states.LiveStates, machine: Machine) -> None:
            inlet.ask()
            before(self, machine)
            seen.append(json.loads(inlet.take() or b""))

        monkeypatch.setattr(states.LiveStates, "__call__", asked)
        result, _ = _run(case, tmp_path / "out", pipe)
    table = result.series.table().to_pandas()
    running = [one for one in seen if one["channel"] == "running"]
    # A state follows the SYNC at its own instant; its values are those of the cycle before
    rows = table.set_index((table["time_ns"] // MS) * MS)
    for one in running:
        row, (axis,) = rows.loc[one["time_ns"] - MS], one["axes"]
        assert (axis["set"], axis["actual"], axis["lag"]) == (
            *(row["Z.set_mm"], row["Z.actual_mm"], row["Z.cnc_lag_mm"]),
        )
    (record,) = result.facts.runs
    latch = running[-1]["axes"][0]["latch"]
    assert latch["position"] == record.latched_mm["Z"]
    assert latch["time_ns"] == record.signal_ns
    assert running[-1]["probes"][0]["edges"] == len(result.facts.probes["probe"].edges)
    assert running[-1]["bus"][0]["frames"] <= result.facts.buses[0].frames


@pytest.mark.long
def test_the_line_of_a_live_view_is_that_of_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cycle and AL state while it runs, wrong counters as they come; it ends as the facts do."""
    case, pipe, seen = _case("ethercat.csv", "counter-wrong-4"), tmp_path / "pipe", list[Any]()
    before: Look = states.LiveStates.__call__
    with closing(Inlet(pipe)) as inlet:

        def asked(self: states.LiveStates, machine: Machine) -> None:
            inlet.ask()
            before(self, machine)
            (segment,) = json.loads(inlet.take() or b"")["bus"]
            seen.append(segment["line"])

        monkeypatch.setattr(states.LiveStates, "__call__", asked)
        result, _ = _run(case, tmp_path / "out", pipe)
    assert seen[0]["slaves"][0] != ["Z", "OP"]
    assert ["Z", "OP"] in [one["slaves"][0] for one in seen]
    assert {0, 1, 2, 3, 4} == {one["wrong"] for one in seen}
    line = result.facts.buses[0].line
    assert line is not None
    assert seen[-1]["period_us"] == line.period_us == 1000.0
    assert (seen[-1]["counter"], seen[-1]["wrong"]) == (line.counter, line.wrong) == (3, 4)
    assert [tuple(slave) for slave in seen[-1]["slaves"]] == list(line.slaves)
