"""What stops a channel, and how: which alarm, which motion, and that it ends."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.bench.bus.can.faults import Drop, FrameFault
from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
MS, S = 1_000_000, 1_000_000_000
T_S = 1e-3
A_MM_S2 = 1000.0


def _moving(bench: Any, axis: str, behind_mm: float) -> None:
    """Run until the interpolation of an axis is `behind_mm` away from where it started."""
    start_mm = bench.axes[axis].position_at(0) * 1e3

    def far() -> bool:
        return bool(bench.samples) and abs(bench.set_mm(axis)[-1] - start_mm) >= behind_mm

    assert bench.scheduler.run_while(lambda: not far(), 10 * S)


def _assert_braked(values: list[float], v_mm_s: float) -> None:
    """From the last full step on: constant deceleration, v^2/2a further, then standstill."""
    steps = [b - a for a, b in pairwise(values)]
    full = max(n for n, step in enumerate(steps) if abs(step - v_mm_s * T_S) < 1e-9)
    assert values[-1] - values[full + 1] == pytest.approx(v_mm_s**2 / (2 * A_MM_S2), abs=1e-9)
    braking = steps[full + 1 : full + 6]
    expected = [v_mm_s * T_S - (k + 0.5) * A_MM_S2 * T_S**2 for k in range(5)]
    assert braking == pytest.approx(expected, abs=1e-9)


# 50059


@pytest.mark.provokes(50059, 4, axis="Z")
def test_50059_comes_before_anything_moves(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z", start_mm=130.0, may_measure=False))
    bench.run([words.probe(2, 600.0, Y=10.0, Z=60.0), words.wait(2), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values) == (50059, {"axis": "Z"})
    assert "N20" in str(alarm)
    assert set(bench.set_mm("Y")) == {0.0}
    assert len(set(bench.set_mm("Z"))) == 1
    assert bench.channel.records == []


@pytest.mark.long
def test_an_axis_that_stands_still_needs_no_release(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(
        words.axis("Y", may_measure=False), words.axis("Z", start_mm=130.0), plane_mm=120.0
    )
    bench.run([words.probe(2, 600.0, Z=110.0), words.wait(2), words.end()])
    assert bench.alarm_ids == []


@pytest.mark.provokes(50052, 4, axis="Z")
def test_50052_when_the_probe_is_deflected_before_the_run(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=140.0)
    bench.run([words.probe(3, 600.0, Z=110.0), words.wait(3), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values["axis"]) == (50052, "Z")
    assert len(set(bench.set_mm("Z"))) == 1


def test_900103_for_a_run_without_path(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run([words.probe(3, 600.0, Z=0.0), words.wait(3), words.end()])
    assert bench.alarm_ids == [900103]


@pytest.mark.long
@pytest.mark.provokes(900003, 4, axis="Y", others="Z")
def test_900003_when_the_probe_is_not_led_to_one_of_the_axes(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(
        words.axis("Y", probed=False), words.axis("Z", start_mm=40.0), plane_mm=30.0
    )
    bench.run([words.probe(1, 1200.0, Y=20.0, Z=0.0), words.wait(1), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values) == (900003, {"axis": "Y", "others": "Z"})
    # What was armed is disarmed: the last RPDO1 of both carry probe function 0
    for node in (1, 2):
        last = [data for _, can_id, data in bench.frames if can_id == 0x200 + node][-1]
        assert last[6:8] == b"\x00\x00"


@pytest.mark.long
@pytest.mark.provokes(900001, 4, axis="Z")
def test_900001_when_the_position_never_comes(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=40.0), plane_mm=30.0, missing_cycles=100_000)
    bench.segment.add_fault(FrameFault(0x281))
    bench.run([words.probe(1, 1200.0, Z=0.0), words.wait(1), words.end()])
    assert bench.alarm_ids == [900001]
    assert bench.channel.measured_acs_mm("Z") is None


# Exact stop


@pytest.mark.long
@pytest.mark.provokes(70082, 5, axis="Z", window_mm="0.0100", ms=51)
def test_70082_when_an_axis_stays_outside_its_window(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(
        words.axis("Z", kv=400.0, droop_mm=0.05, window_mm=0.01, settling_ns=50 * MS)
    )
    bench.run([words.move(1, 3000.0, Z=20.0), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == 70082
    assert alarm.values["axis"] == "Z"
    assert float(alarm.values["lag_mm"]) == pytest.approx(0.05, abs=5e-4)
    assert float(alarm.values["window_mm"]) == 0.01
    # The first whole cycle behind the 50 ms
    assert alarm.values["ms"] == 51
    standing = next(s.time_ns for s in bench.samples if s.set_mm == (20.0,))
    assert bench.channel.alarm_ns[0] - standing == pytest.approx(52 * MS, abs=MS)


@pytest.mark.long
def test_the_window_may_be_reached_late(channel_bench: Make, words: Any) -> None:
    """A loop of 10 1/s needs ln(x/w)/Kv: it gets there inside the settling time."""
    bench = channel_bench(words.axis("Z", kv=10.0, window_mm=0.01, settling_ns=2 * S))
    bench.run([words.move(1, 600.0, Z=5.0), words.end()])
    assert bench.alarm_ids == []
    assert bench.links[0].actual_mm == pytest.approx(5.0, abs=0.011)


@pytest.mark.long
def test_settling_time_0_is_not_watched(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", droop_mm=0.05, window_mm=0.01, settling_ns=0))
    bench.prepare([words.move(1, 3000.0, Z=2.0), words.end()])
    assert not bench.scheduler.run_while(lambda: not bench.channel.has_ended, 3 * S)
    assert bench.alarm_ids == []


# Drives


def _fault_in_motion(channel_bench: Make, words: Any) -> Any:
    """Z is given a following error window that the running lag exceeds, while Y and Z move."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
    _moving(bench, "Y", 12.0)
    bench.remotes["Z"].sdo[0x6066].raw = 0
    bench.remotes["Z"].sdo[0x6065].raw = 1
    bench.finish()
    return bench


@pytest.mark.long
@pytest.mark.provokes(900005, 7, axis="Z")
def test_900005_tells_statusword_and_emergency(channel_bench: Make, words: Any) -> None:
    (alarm,) = _fault_in_motion(channel_bench, words).channel.alarms
    assert alarm.id == 900005
    assert "(line 1, block N10)" in str(alarm)
    assert alarm.values["axis"] == "Z"
    assert str(alarm.values["emcy"]).startswith("0x8611, following error, error register 0x")
    # xxxx xxxx x0xx 1x00: fault or fault reaction (CiA 402), bit 13: following error
    assert int(str(alarm.values["statusword"]), 16) & 0x2048 == 0x2008


@pytest.mark.long
def test_a_drive_fault_brakes_every_axis(channel_bench: Make, words: Any) -> None:
    """A 3-4-5 path at 50 mm/s; a of the path is the smallest limit / share = 1000 / 0.8."""
    bench = _fault_in_motion(channel_bench, words)
    path = [value / 0.6 for value in bench.set_mm("Y")]
    assert path[-1] < 90.0
    steps = [b - a for a, b in pairwise(path)]
    full = max(n for n, step in enumerate(steps) if abs(step - 0.05) < 1e-9)
    assert path[-1] - path[full + 1] == pytest.approx(50.0**2 / (2 * 1250.0), abs=1e-9)
    assert bench.set_mm("Z") == pytest.approx([value / 0.6 * 0.8 for value in bench.set_mm("Y")])


@pytest.mark.long
def test_a_faulty_drive_is_not_switched_on_again(channel_bench: Make, words: Any) -> None:
    """Nobody has acknowledged: neither a reset (bit 7) nor torque behind the alarm."""
    bench = _fault_in_motion(channel_bench, words)
    alarm_ns = bench.channel.alarm_ns[0]
    words_sent = [
        int.from_bytes(data[:2], "little")
        for time_ns, can_id, data in bench.frames
        if can_id == 0x202 and time_ns > alarm_ns
    ]
    assert words_sent
    assert not any(word & 0x80 for word in words_sent)


@pytest.mark.long
def test_an_alarm_of_a_standing_axis_brakes_the_moving_one(channel_bench: Make, words: Any) -> None:
    """Y moves; Z stands, is pushed 0.5 mm away, and its drive faults."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Y=60.0), words.end()])
    _moving(bench, "Y", 12.0)
    bench.remotes["Z"].sdo[0x6066].raw = 0
    bench.remotes["Z"].sdo[0x6065].raw = 1
    bench.axes["Z"].droop_m = 0.5e-3
    bench.finish()
    assert bench.alarm_ids == [900005]
    _assert_braked(bench.set_mm("Y"), 50.0)


@pytest.mark.parametrize("moving", [True, False])
@pytest.mark.provokes(900006, 7, axis="Z", pdo="TPDO1", cycles=4)
def test_900006_ends_the_program(channel_bench: Make, words: Any, moving: bool) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Z=60.0), words.end()])
    if moving:
        _moving(bench, "Z", 12.0)
    bench.segment.add_fault(FrameFault(0x181))
    assert bench.scheduler.run_while(lambda: not bench.channel.has_ended, 2 * S)
    assert bench.alarm_ids == [900006]
    # Told to stand from the first cycle on: no block has begun
    assert bench.channel.alarms[0].place == ("line 1, block N10" if moving else None)


@pytest.mark.long
def test_an_alarm_names_the_block_under_execution(channel_bench: Make, words: Any) -> None:
    """N20 moves when the telegrams stay out."""
    bench = channel_bench(words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Z=5.0), words.move(2, 3000.0, Z=60.0), words.end()])
    _moving(bench, "Z", 12.0)
    bench.segment.add_fault(FrameFault(0x181))
    bench.finish()
    assert "(line 2, block N20)" in str(bench.channel.alarms[0])


@pytest.mark.long
@pytest.mark.provokes(900008, 4, axis="Z", state="SWITCH_ON_DISABLED")
def test_900008_when_a_drive_never_gets_ready(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    bench.segment.add_fault(FrameFault(0x202))  # no controlword reaches Z
    bench.run([words.move(1, 3000.0, Z=60.0), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.values["axis"]) == (900008, "Z")
    assert alarm.values["state"] == "SWITCH_ON_DISABLED"
    assert set(bench.set_mm("Z")) == {0.0}


@pytest.mark.provokes(900012, 2, axis="Z", target_mm=20480)
def test_900012_for_a_target_beyond_32_bits(channel_bench: Make, words: Any) -> None:
    """2^31 increments of 10 mm / 2^20 are 20480 mm."""
    bench = channel_bench(words.axis("Z"))
    bench.run([words.move(1, 3000.0, Z=20480.0), words.end()])
    assert bench.alarm_ids == [900012]
    assert bench.final_mm("Z") == 0.0


def _faulty_at_start(channel_bench: Make, words: Any, **options: Any) -> Any:
    """The drive of Z has a fault before it is switched on."""
    bench = channel_bench(words.axis("Z"), **options)
    bench.prepare([words.move(1, 3000.0, Z=2.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples, S)
    bench.nodes["Z"].servo.fault(0x4310, 1 << 3, bench.scheduler.now_ns)
    bench.finish()
    return bench


def test_900005_for_a_fault_that_stands_at_power_up(channel_bench: Make, words: Any) -> None:
    bench = _faulty_at_start(channel_bench, words)
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900005
    assert "excess temperature of the drive" in str(alarm)
    assert bench.scheduler.now_ns < 200 * MS


def test_900005_asks_for_a_fault_that_came_before_anybody_listened(
    channel_bench: Make, words: Any
) -> None:
    """0x4310 stands since before the start: its emergency went by, 603F and 1003:1 have it."""
    bench = channel_bench(words.axis("Z"))
    bench.scheduler.run_until(5 * MS)
    bench.nodes["Z"].servo.fault(0x4310, 1 << 3, bench.scheduler.now_ns)
    bench.scheduler.run_until(10 * MS)
    bench.run([words.move(1, 3000.0, Z=2.0), words.end()])
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900005
    assert "0x603F:0 and 0x1003:1 say 0x4310, excess temperature of the drive" in str(alarm)
    assert "fault_reset" in str(alarm)
    asked = [d[1:4].hex() for _, can_id, d in bench.frames if can_id == 0x601 and d[0] == 0x40]
    assert asked[-2:] == ["3f6000", "031001"]
    assert bench.scheduler.now_ns < 200 * MS


@pytest.mark.long
def test_a_drive_that_knows_no_code_is_faulty_all_the_same(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.scheduler.run_until(5 * MS)
    bench.nodes["Z"].servo.fault(0x4310, 1 << 3, bench.scheduler.now_ns)
    bench.scheduler.run_until(10 * MS)
    drop = lambda frame, _port, _attempt: Drop() if frame.arbitration_id == 0x581 else None  # noqa: E731
    bench.prepare([words.move(1, 3000.0, Z=2.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples, S)
    bench.segment.add_fault(drop)
    bench.finish()
    (alarm,) = bench.channel.alarms
    assert alarm.id == 900005
    assert "emergency code none" in str(alarm)
    assert bench.scheduler.now_ns < 700 * MS


def test_a_rig_may_have_such_a_fault_acknowledged(channel_bench: Make, words: Any) -> None:
    """By the rising edge of bit 7; the program then runs."""
    bench = _faulty_at_start(channel_bench, words, fault_reset=True)
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == 2.0
    sent = [int.from_bytes(d[:2], "little") for _, can_id, d in bench.frames if can_id == 0x201]
    assert 0x80 in sent


def test_an_alarm_of_the_interpreter_ends_the_program_standing(
    channel_bench: Make, words: Any
) -> None:
    def commands() -> Any:
        yield words.move(1, 3000.0, Z=5.0)
        yield words.wait(1)
        raise Alarm(20008, word="G1")

    bench = channel_bench(words.axis("Z"))
    bench.run(commands())
    assert bench.alarm_ids == [20008]
    assert bench.final_mm("Z") == 5.0


# From outside


@pytest.mark.provokes(900070, 4)
@pytest.mark.provokes(900071, 7, segment="can1", reason="adapter is gone")
@pytest.mark.parametrize(
    ("alarm_id", "values"),
    [(900070, {}), (900071, {"segment": "can1", "reason": "adapter is gone"})],
)
def test_operator_and_lost_interface_brake_between_two_cycles(
    channel_bench: Make, words: Any, alarm_id: int, values: dict[str, str]
) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Z=60.0), words.end()])
    _moving(bench, "Z", 12.0)
    bench.channel.stop(Alarm(alarm_id, **values))
    bench.finish()
    assert bench.alarm_ids == [alarm_id]
    _assert_braked(bench.set_mm("Z"), 50.0)
