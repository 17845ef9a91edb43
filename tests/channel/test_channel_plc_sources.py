"""Signals and hardware at the PLC (P-AXIS-00516), with a PLC that a test writes cycle by cycle.

The probe is a plane at 120 mm; the PLC reports it when the axis, as the CNC sees it, is past it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.plc.probing import AxisWrites, LatchTask, PlcTask, StampRelation

MS = 1_000_000
PLANE_MM = 120.0
INCREMENT_MM = 10 / 2**20
Make = Callable[..., Any]
TO = 119.0


@dataclass
class Plc:
    """A PLC with a cycle for every one of the CNC; it acknowledges at once.

    acknowledges: the tasks that it does. stamp: what it writes as time stamp at an instant, None:
    not enabled. position_units: of probing_position. orders: what the CNC has asked for.
    """

    bench: Any
    axis: str = "Z"
    enables: bool = True
    acknowledges: tuple[LatchTask, ...] = tuple(LatchTask)
    stamp: Callable[[int], int | None] = lambda _now_ns: None
    position_units: int | None = None
    stops_ns: int | None = None
    level: Callable[[], bool] | None = None
    orders: list[tuple[LatchTask, int, str]] = field(default_factory=list)
    _seen: int = 0
    _done: int = 0

    def __post_init__(self) -> None:
        plc = self.bench.channel.plc
        self.unit = plc.axis[self.axis].probing
        self.task = PlcTask(
            cycle_ns=MS, watchdog_ns=5 * MS, acknowledge_ns=50 * MS, stamps=StampRelation()
        )
        plc.join(PlcParticipant(self.turn, task=self.task))

    def _level(self) -> bool:
        if self.level is not None:
            return self.level()
        (link,) = [link for link in self.bench.links if link.name == self.axis]
        return bool(link.actual_mm < PLANE_MM)

    def turn(self) -> None:
        now_ns = self.bench.scheduler.now_ns
        for axis in self.bench.channel.plc.axis:
            self.task.sync_ns[axis] = now_ns // MS * MS + 48_000
        if self.stops_ns is not None and now_ns >= self.stops_ns:
            return
        self.task.written_ns = now_ns
        order = self.unit.order
        if self.unit.number != self._seen:
            self._seen = self.unit.number
            self.orders.append((order.task, order.probe_input, order.edge))
        if order.task in self.acknowledges:
            self._done = self._seen
        is_past = self._level()
        writes = AxisWrites(
            is_past if self.enables else None,
            self.stamp(now_ns),
            self.position_units,
            self._done,
        )
        self.unit.take(writes, now_ns)


def _run(
    channel_bench: Make, words: Any, source: str, runs: int = 1, **plc: Any
) -> tuple[Any, Plc]:
    bench = channel_bench(words.axis("Z", start_mm=122.0, source=source), plane_mm=PLANE_MM)
    side = Plc(bench, **plc)
    blocks = []
    for number in range(runs):
        blocks += [words.probe(2 * number + 1, 600.0, Z=TO), words.wait(2 * number + 1)]
        blocks.append(words.move(2 * number + 2, 3000.0, Z=122.0))
    bench.run([*blocks, words.end()])
    return bench, side


@pytest.mark.long
def test_the_actual_position_of_the_cycle_that_sees_the_signal_is_the_value(
    channel_bench: Make, words: Any
) -> None:
    bench, _ = _run(channel_bench, words, "PLC")
    (record,) = bench.channel.records
    assert bench.alarm_ids == []
    past_mm = PLANE_MM - record.latched_mm["Z"]
    assert 0.0 < past_mm <= 10.0e-3 + INCREMENT_MM  # up to a cycle at 10 mm/s


@pytest.mark.long
def test_an_enabled_probing_position_is_the_value(channel_bench: Make, words: Any) -> None:
    bench, _ = _run(channel_bench, words, "PLC", position_units=1_234_567)
    assert bench.channel.measured_acs_mm("Z") == pytest.approx(123.4567, abs=1e-9)


@pytest.mark.long
def test_a_stamp_gives_the_place_at_its_instant(channel_bench: Make, words: Any) -> None:
    """Ten cycles before the signal is seen the axis was 0.1 mm higher."""
    bench, _ = _run(channel_bench, words, "PLC_TIMESTAMP", stamp=lambda now_ns: now_ns - 10 * MS)
    (record,) = bench.channel.records
    assert bench.alarm_ids == []
    seen_mm = record.latched_mm["Z"] - 0.1 + 10.0e-6 * 572  # the cycle is 572 us after its SYNC
    assert PLANE_MM - 10.0e-3 - 0.001 < seen_mm < PLANE_MM + 0.001


@pytest.mark.long
@pytest.mark.parametrize(("known_cycles", "is_found"), [(120, True), (10, False)])
def test_an_edge_before_the_rest_is_waited_for_as_long_as_the_task_may_be_late(
    channel_bench: Make, words: Any, known_cycles: int, is_found: bool
) -> None:
    """The axis creeps to 119 mm with 1/Kv = 25 ms: 2 um before it some 120 ms after its set
    position, at rest to an increment in a cycle some 50 ms later; the PLC hands the edge over
    another 50 ms later, with its stamp.
    """
    axis = words.axis("Z", start_mm=122.0, source="PLC_TIMESTAMP")
    bench = channel_bench(axis, plane_mm=PLANE_MM)
    (link,) = bench.links
    crossed_ns: list[int] = []

    def level() -> bool:
        now_ns = bench.scheduler.now_ns
        if not crossed_ns and link.actual_mm < TO + 0.002:
            crossed_ns.append(now_ns)
        return bool(crossed_ns) and now_ns >= crossed_ns[0] + 100 * MS

    side = Plc(bench, level=level, stamp=lambda _: crossed_ns[0] if crossed_ns else 0)
    side.task.late_cycles = known_cycles
    bench.run([words.probe(1, 600.0, Z=TO), words.wait(1), words.end()])
    measured_mm = bench.channel.measured_acs_mm("Z")
    assert bench.alarm_ids == []
    if is_found:
        assert measured_mm == pytest.approx(TO + 0.002, abs=0.0002)
    else:
        assert measured_mm is None


@pytest.mark.long
def test_a_level_that_hardware_shows_until_it_is_enabled_ends_no_run(
    channel_bench: Make, words: Any
) -> None:
    """Of two axes Z is enabled first and drops its level then; Y is enabled 20 cycles later."""
    axes = [words.axis(n, start_mm=122.0, source="PLC_EXT_LATCH_CONTROL") for n in ("Y", "Z")]
    bench = channel_bench(*axes, plane_mm=PLANE_MM)
    links = {link.name: link for link in bench.links}
    units = {name: bench.channel.plc.axis[name].probing for name in ("Y", "Z")}
    task = PlcTask(MS, 5 * MS, 50 * MS)
    enabled_ns: dict[str, int] = {}

    def turn() -> None:
        now_ns = task.written_ns = bench.scheduler.now_ns
        for name, unit in units.items():
            task.sync_ns[name] = now_ns // MS * MS + 48_000
            is_enable = unit.order.task is LatchTask.ENABLE
            if is_enable:
                enabled_ns.setdefault(name, now_ns + (2 if name == "Z" else 20) * MS)
            done = not is_enable or now_ns >= enabled_ns[name]
            still_shown = name == "Z" and is_enable and now_ns <= enabled_ns[name]
            level = still_shown or links[name].actual_mm < PLANE_MM
            number = unit.number if done else unit.number - 1
            unit.take(AxisWrites(level, done_order=number), now_ns)

    bench.channel.plc.join(PlcParticipant(turn, task=task))
    bench.run([words.probe(1, 600.0, Y=TO, Z=TO), words.wait(1), words.end()])
    assert bench.alarm_ids == []
    (record,) = bench.channel.records
    for name in ("Y", "Z"):
        assert record.latched_mm[name] == pytest.approx(PLANE_MM, abs=0.02)


@pytest.mark.long
def test_the_dead_time_of_the_probe_leads_a_value_back(channel_bench: Make, words: Any) -> None:
    """P-AXIS-00487: 10 ms at 10 mm/s; the axis comes from above."""
    values = []
    for delay_ns in (0, 10 * MS):
        axis = words.axis("Z", start_mm=125.0, source="PLC_TIMESTAMP", delay_ns=delay_ns)
        bench = channel_bench(axis, plane_mm=PLANE_MM)
        Plc(bench, stamp=lambda now_ns: now_ns - 3 * MS)
        bench.run([words.probe(1, 600.0, Z=TO), words.wait(1), words.end()])
        values.append(bench.channel.measured_acs_mm("Z"))
    assert values[1] - values[0] == pytest.approx(0.1, abs=21 * INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("source", ["PLC", "PLC_TIMESTAMP"])
def test_a_stop_may_take_longer_than_the_history_lasts(
    channel_bench: Make, words: Any, source: str
) -> None:
    """From 10 mm/s with 10 mm/s2: 1 s, of which 512 cycles of 1 ms are known at its end."""
    axis = words.axis("Z", start_mm=125.0, source=source, delay_ns=10 * MS, stop_mm_s2=10.0)
    bench = channel_bench(axis, plane_mm=PLANE_MM)
    Plc(bench, stamp=lambda now_ns: now_ns - 3 * MS)
    bench.run([words.probe(1, 600.0, Z=100.0), words.wait(1), words.end()])
    (record,) = bench.channel.records
    assert bench.alarm_ids == []
    assert record.end_ns - record.signal_ns >= 1000 * MS
    # The stamp is 3 ms before a cycle that is 0.552 ms after its SYNC; led back by 10 ms at 10 mm/s
    early_mm = 0.1 + (10.0 * (3.0 - 0.552) * 1e-3 if source == "PLC_TIMESTAMP" else 0.0)
    past_mm = PLANE_MM + early_mm - record.latched_mm["Z"]
    assert -21 * INCREMENT_MM <= past_mm <= 0.02  # the signal is up to two cycles late


@pytest.mark.provokes(900401, 4, axis="Z", unit="probing_signal")
def test_900401_for_a_signal_that_is_not_enabled(channel_bench: Make, words: Any) -> None:
    bench, _ = _run(channel_bench, words, "PLC", enables=False)
    assert (bench.alarm_ids, bench.channel.records[0].latched_mm) == ([900401], {})


@pytest.mark.provokes(900401, 4, axis="Z", unit="timestamp")
def test_900401_for_a_stamp_that_is_not_enabled(channel_bench: Make, words: Any) -> None:
    bench, _ = _run(channel_bench, words, "PLC_TIMESTAMP")
    assert (bench.alarm_ids, bench.channel.records[0].latched_mm) == ([900401], {})


@pytest.mark.provokes(900402, 4, axis="Z")
def test_900402_when_the_task_falls_silent_in_a_run(channel_bench: Make, words: Any) -> None:
    bench, _ = _run(channel_bench, words, "PLC", stops_ns=180 * MS)
    assert (bench.alarm_ids, bench.channel.records[0].latched_mm) == ([900402], {})


@pytest.mark.long
@pytest.mark.provokes(900403, 4, axis="Z", ahead_us="10")
@pytest.mark.provokes(900404, 4, axis="Z")
@pytest.mark.provokes(900405, 4, axis="Z")
@pytest.mark.parametrize(
    ("alarm_id", "shift_ns"), [(900403, 10_000), (900404, -600 * MS), (900405, -220 * MS)]
)
def test_a_stamp_that_cannot_be_of_this_run(
    channel_bench: Make, words: Any, alarm_id: int, shift_ns: int
) -> None:
    bench = channel_bench(
        words.axis("Z", start_mm=122.0, source="PLC_TIMESTAMP"), plane_mm=PLANE_MM
    )
    Plc(bench, stamp=lambda now_ns: now_ns + shift_ns)
    # The first run, without a signal, lets the history begin
    blocks = [words.probe(1, 3000.0, Z=121.0), words.wait(1), words.move(2, 60.0, Z=120.9)]
    bench.run([*blocks, words.probe(3, 600.0, Z=TO), words.wait(3), words.end()])
    assert bench.alarm_ids == [alarm_id]
    assert bench.channel.records[-1].latched_mm == {}


@pytest.mark.provokes(50052, 4, axis="Z")
def test_50052_for_a_signal_before_the_run(channel_bench: Make, words: Any) -> None:
    bench, _ = _run(channel_bench, words, "PLC", level=lambda: True)
    assert bench.alarm_ids == [50052]


@pytest.mark.long
def test_hardware_gets_its_tasks_with_input_and_edge(channel_bench: Make, words: Any) -> None:
    """The signal rises though the edge in the task is NEG; DISABLE follows each run."""
    bench = channel_bench(
        words.axis("Z", start_mm=122.0, source="PLC_EXT_LATCH_CONTROL"), plane_mm=PLANE_MM
    )
    side = Plc(bench)
    chosen = words.probe_settings(1, "Z", edge="NEG", probe_input=200)
    blocks = [chosen, words.probe(2, 600.0, Z=TO), words.wait(2)]
    bench.run([*blocks, words.move(3, 600.0, Z=121.0), words.end()])
    assert bench.alarm_ids == []
    assert side.orders == [(LatchTask.ENABLE, 200, "NEG"), (LatchTask.DISABLE, 200, "NEG")]


@pytest.mark.provokes(900227, 2, keyword="INPUT", value=3, allowed="1 .. 2")
def test_900227_for_an_input_that_the_source_does_not_have(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=122.0), plane_mm=PLANE_MM)
    bench.run([words.probe_settings(1, "Z", probe_input=3), words.end()])
    assert bench.alarm_ids == [900227]


@pytest.mark.long
def test_an_input_of_external_hardware_is_none_of_the_drive(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=122.0), plane_mm=PLANE_MM)
    Plc(bench)
    external = words.probe_settings(1, "Z", source="PLC_EXT_LATCH_CONTROL", probe_input=200)
    drive = words.probe_settings(2, "Z", source="DRIVE")
    bench.run([external, drive, words.probe(3, 600.0, Z=TO), words.wait(3), words.end()])
    (record,) = bench.channel.records
    assert (bench.alarm_ids, record.inputs, record.sources) == ([], {"Z": 1}, {"Z": "DRIVE"})
    assert record.has_signal


@pytest.mark.provokes(50050, 4, axis="Z")
@pytest.mark.parametrize("source", ["PLC_EXT_LATCH_CONTROL", "EXT_PROBE_WITH_DRIVE"])
def test_50050_when_enable_is_not_acknowledged(
    channel_bench: Make, words: Any, source: str
) -> None:
    bench, _ = _run(channel_bench, words, source, acknowledges=(LatchTask.DISABLE,))
    assert bench.alarm_ids == [50050]
    assert bench.channel.records[0].start_ns is None


@pytest.mark.long
@pytest.mark.provokes(900406, 4, axis="Z")
@pytest.mark.parametrize("source", ["PLC_EXT_LATCH_CONTROL", "EXT_PROBE_WITH_DRIVE"])
def test_900406_when_disable_is_not_acknowledged(
    channel_bench: Make, words: Any, source: str
) -> None:
    acknowledged = (LatchTask.PREPARE, LatchTask.ENABLE)
    bench, _ = _run(channel_bench, words, source, runs=2, acknowledges=acknowledged)
    first, second = bench.channel.records
    assert bench.alarm_ids == [900406]
    assert (first.has_signal, second.start_ns) == (True, None)


@pytest.mark.long
def test_a_switched_probe_is_latched_by_the_drive(channel_bench: Make, words: Any) -> None:
    bench, side = _run(channel_bench, words, "EXT_PROBE_WITH_DRIVE", runs=2)
    assert bench.alarm_ids == []
    for record in bench.channel.records:
        assert record.latched_mm["Z"] == pytest.approx(PLANE_MM, abs=INCREMENT_MM)
    assert [task for task, _, _ in side.orders] == 2 * [LatchTask.ENABLE, LatchTask.DISABLE]


@pytest.mark.parametrize("measures", [True, False])
def test_a_preparation_ends_with_the_program_at_the_latest(
    channel_bench: Make, words: Any, measures: bool
) -> None:
    bench = channel_bench(
        words.axis("Z", start_mm=122.0, source="EXT_PROBE_WITH_DRIVE"), plane_mm=PLANE_MM
    )
    side = Plc(bench)
    run = [words.probe(3, 600.0, Z=TO), words.wait(3)] if measures else []
    blocks = [words.prepare(1, "Z"), words.move(2, 600.0, Z=121.5), *run]
    blocks.append(words.move(4, 600.0, Z=121.0))
    bench.run([*blocks, words.end()])
    last = [(LatchTask.DISABLE, 1, "POS")] if measures else []
    tasks = [LatchTask.PREPARE, *([LatchTask.ENABLE] if measures else [])]
    assert side.orders == [(task, 1, "POS") for task in tasks] + last
    assert side.unit.order.task is LatchTask.DISABLE  # at the end nobody reads it any more


@pytest.mark.long
def test_a_preparation_that_is_reset_switches_the_probe_off(
    channel_bench: Make, words: Any
) -> None:
    """Homing or exchange of a prepared axis does; then the run enables the probe as ever."""
    bench = channel_bench(
        words.axis("Z", start_mm=122.0, source="EXT_PROBE_WITH_DRIVE"), plane_mm=PLANE_MM
    )
    side, measurement = Plc(bench), bench.channel.measurement

    def forget(_channel: Any) -> None:
        if side.orders and measurement.prepared:
            measurement.forget_prepared("Z")

    bench.channel.observers.append(forget)
    blocks = [words.prepare(1, "Z"), words.move(2, 600.0, Z=121.5)]
    bench.run([*blocks, words.probe(3, 600.0, Z=TO), words.wait(3), words.move(4, 600.0, Z=121.0),
               words.end()])  # fmt: skip
    tasks = [LatchTask.PREPARE, LatchTask.DISABLE, LatchTask.ENABLE, LatchTask.DISABLE]
    assert [task for task, _, _ in side.orders] == tasks
    assert bench.channel.records[0].has_signal


@pytest.mark.long
def test_the_first_event_counts_for_every_axis(channel_bench: Make, words: Any) -> None:
    """PLC_FIRST_EVENT: the unit of Y never signals; Y has its place of the same cycle, 1 mm below.

    Both go on by the way of the stop, and what they have is of the event.
    """
    places = {"Y": 121.0, "Z": 122.0}
    axes = [words.axis(n, start_mm=at, source="PLC_FIRST_EVENT") for n, at in places.items()]
    bench = channel_bench(*axes, plane_mm=PLANE_MM)
    Plc(bench)

    def turn() -> None:
        other = bench.channel.plc.axis["Y"].probing
        other.take(AxisWrites(signal=False), bench.scheduler.now_ns)

    bench.channel.plc.join(PlcParticipant(turn))
    bench.run([words.probe(1, 600.0, Y=TO - 1.0, Z=TO), words.wait(1), words.end()])
    (record,) = bench.channel.records
    assert bench.alarm_ids == []
    past_mm = PLANE_MM - record.latched_mm["Z"]
    assert 0.0 < past_mm <= 10.0e-3 + INCREMENT_MM
    assert record.latched_mm["Y"] == pytest.approx(
        record.latched_mm["Z"] - 1.0, abs=2 * INCREMENT_MM
    )


def test_an_edge_of_the_falling_signal(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=119.0, source="PLC"), plane_mm=PLANE_MM)
    Plc(bench)
    chosen = words.probe_settings(1, "Z", edge="NEG")
    bench.run([chosen, words.probe(2, 600.0, Z=121.0), words.wait(2), words.end()])
    assert bench.alarm_ids == []
    assert 0.0 <= bench.channel.measured_acs_mm("Z") - PLANE_MM <= 10.0e-3 + INCREMENT_MM


def test_a_run_is_refused_without_a_task(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", source="PLC_TIMESTAMP"))
    with pytest.raises(Alarm, match="900400"):
        bench.channel.measurement.check("Z", 1)


def test_the_level_of_a_signal_that_nothing_has_asked_for_is_not_that_of_the_drive(
    channel_bench: Make, words: Any
) -> None:
    """Y measures with its drive, whose probe is free; the PLC of Z has given nothing yet."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=130.0, source="PLC"))
    found: list[tuple[bool | None, bool | None]] = []
    measurement = bench.channel.measurement
    turn = PlcParticipant(
        lambda: found.append((measurement.is_actuated("Y"), measurement.is_actuated("Z")))
    )
    bench.channel.plc.join(turn)
    bench.run([words.move(1, 600.0, Y=1.0), words.end()])
    assert set(found) == {(False, None)}


@pytest.mark.long
def test_meas_waits_for_a_probe_at_the_plc_that_an_axis_beside_the_path_has_armed(
    channel_bench: Make, words: Any
) -> None:
    """Its run takes 0.2 s; #MEAS of another axis comes 30 ms after its begin."""
    axes = words.axis("Y"), words.axis("Z", start_mm=122.0, source="PLC")
    bench = channel_bench(*axes, plane_mm=PLANE_MM)
    Plc(bench)
    beside = canon.IndependentMove(words.end(1).block, "Z", TO, feed_mm_min=600.0, measuring_type=1)
    pause = canon.Dwell(words.end(2).block, 30 * MS)
    choice = words.probe_settings(3, "Y", edge="POS")
    bench.run([beside, pause, choice, words.message(4, "chosen", synchronous=True), words.end()])
    assert bench.alarm_ids == []
    (record,) = bench.channel.records
    ((chosen_ns, _),) = bench.messages
    assert record.start_ns < record.end_ns <= chosen_ns
    assert record.end_ns - record.begin_ns > 100 * MS
