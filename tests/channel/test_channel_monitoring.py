"""What goes wrong while axes move: the alarm, how soon, and that every axis stops."""

import struct
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.faults import Alter, Drop, ErrorAtBit, FaultAction
from axisrig.bench.bus.can.frame import Frame
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.drives.canopen.watch import WatchSettings
from axisrig.kernel.time.clock import MS, S

Make = Callable[..., Any]
Change = Callable[[Frame], FaultAction | None]
Z = 2  # node of Z; Y is node 1
RPDO1, TPDO1, TPDO2, EMCY, HEARTBEAT = 0x202, 0x182, 0x282, 0x082, 0x702


class Trouble:
    """Two axes on a straight path; Z meets the trouble once the path is well under way."""

    def __init__(self, channel_bench: Make, words: Any, **options: Any) -> None:
        self.bench = channel_bench(words.axis("Y"), words.axis("Z"), **options)
        self.bench.prepare([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
        moving = lambda: not (self.bench.samples and self.bench.set_mm("Y")[-1] > 12.0)  # noqa: E731
        assert self.bench.scheduler.run_while(moving, 5 * S), self.bench.channel.alarms
        self.begin_ns = self.bench.scheduler.now_ns
        self.other = SimNetwork(self.bench.segment.port("other master")).connect()

    def change(self, can_id: int, action: Change, count: int = 10**9) -> None:
        """Let `action` act on frames with one identifier, `count` of them."""
        left = [count]

        def hook(frame: Frame, _port: Any, _attempt: int) -> FaultAction | None:
            if frame.arbitration_id != can_id or not left[0]:
                return None
            left[0] -= 1
            return action(frame)

        self.bench.segment.add_fault(hook)

    def only_alarm(self, cycles_max: int) -> Any:
        """Run to the end; the alarm, that came within so many cycles and stopped both axes."""
        self.bench.finish()
        (alarm,) = self.bench.channel.alarms
        late_ns = self.bench.channel.alarm_ns[0] - self.begin_ns
        assert late_ns <= cycles_max * MS, f"{alarm} after {late_ns / MS} ms"
        for name in ("Y", "Z"):
            set_mm = self.bench.set_mm(name)
            steps = [b - a for a, b in pairwise(set_mm)]
            assert 0.0 <= steps[-1] <= 0.0015  # the end of a ramp: a T^2 = 1 um per cycle
            assert max(a - b for a, b in pairwise(steps)) <= 0.0015  # and no step in the speed
        assert self.bench.final_mm("Y") < 60.0  # it was stopped and did not arrive
        return alarm

    @property
    def controlwords_behind_the_alarm(self) -> set[int]:
        """What Z was told, from the cycle behind the alarm on."""
        return self.controlwords(RPDO1)

    def controlwords(self, rpdo: int) -> set[int]:
        alarm_ns = self.bench.channel.alarm_ns[0]
        sent = [d for t, can_id, d in self.bench.frames if can_id == rpdo and t > alarm_ns + MS]
        return {struct.unpack_from("<H", data)[0] for data in sent}


@pytest.fixture
def trouble(channel_bench: Make, words: Any) -> Callable[..., Trouble]:
    return lambda **options: Trouble(channel_bench, words, **options)


def _alter(offset: int, form: str, value: int) -> Change:
    def action(frame: Frame) -> FaultAction:
        data = bytearray(frame.data)
        struct.pack_into(form, data, offset, value)
        return Alter(bytes(data))

    return action


@pytest.mark.parametrize(("pdo", "can_id"), [("TPDO1", TPDO1), ("TPDO2", TPDO2)])
@pytest.mark.parametrize("missing_cycles", [1, 3, 7])
@pytest.mark.long(but=1)
def test_900006_for_each_cyclic_telegram_after_the_cycles_of_the_rig(
    trouble: Any, pdo: str, can_id: int, missing_cycles: int
) -> None:
    case = trouble(missing_cycles=missing_cycles)
    case.change(can_id, lambda _frame: Drop())
    alarm = case.only_alarm(missing_cycles + 2)
    assert alarm.id == 900006
    assert alarm.values == {"axis": "Z", "pdo": pdo, "cycles": missing_cycles + 1}


@pytest.mark.long
@pytest.mark.provokes(900024, 7, axis="Z", node=2)
def test_900024_when_the_drive_restarts_and_it_is_not_enabled_again(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(0, bytes((129, Z)))
    alarm = case.only_alarm(2)
    assert (alarm.id, alarm.values["axis"]) == (900024, "Z")
    assert case.controlwords_behind_the_alarm == {0}


@pytest.mark.long
@pytest.mark.provokes(900025, 7, axis="Z")
def test_900025_for_an_emergency_without_a_fault(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x4310, 0x09))
    alarm = case.only_alarm(3)
    assert alarm.id == 900025
    words = "0x4310, excess temperature of the drive, error register 0x09"
    assert alarm.values["emcy"] == words


@pytest.mark.long
def test_the_emergency_of_a_limit_switch_says_so_and_what_to_do(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x8612, 0x01))
    alarm = case.only_alarm(3)
    assert alarm.id == 900025
    assert "a limit switch or a position limit of the drive has stopped the axis" in str(alarm)
    assert "Off a limit switch the axis goes in the other direction" in str(alarm)


@pytest.mark.long
def test_an_unknown_emergency_stops_too(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(EMCY, struct.pack("<HB5x", 0xA123, 0x01))
    alarm = case.only_alarm(3)
    assert alarm.id == 900025
    assert "is not in the table" in str(alarm)


@pytest.mark.provokes(900035, 1, axis="Z")
@pytest.mark.long
def test_900035_warns_and_the_program_goes_on(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x8120, 0x11))
    case.bench.finish()
    assert case.bench.alarm_ids == [900035]
    assert (case.bench.final_mm("Y"), case.bench.final_mm("Z")) == (60.0, 80.0)


@pytest.mark.long
def test_a_warning_of_one_drive_does_not_hide_what_another_one_tells(trouble: Any) -> None:
    """Y warns and Z sends an emergency in one cycle: the program ends because of Z."""
    case = trouble()
    case.other.send_message(0x081, struct.pack("<HB5x", 0x8120, 0x11))
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x4310, 0x09))
    case.bench.finish()
    found = [(alarm.id, alarm.values["axis"]) for alarm in case.bench.channel.alarms]
    assert found == [(900035, "Y"), (900025, "Z")]
    assert case.bench.final_mm("Y") < 60.0


@pytest.mark.long
def test_900005_and_not_900025_for_a_fault_after_a_warning(trouble: Any) -> None:
    """The status word of the fault comes a cycle after its emergency, as after any other."""
    case = trouble()
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x8120, 0x11))
    run_to = case.bench.scheduler.run_until
    for _ in range(10):
        run_to(case.bench.scheduler.now_ns + MS)
    assert case.bench.alarm_ids == [900035]
    case.other.send_message(EMCY, struct.pack("<HB5x", 0x4310, 0x09))
    run_to(case.bench.scheduler.now_ns + MS)
    case.change(TPDO1, _alter(0, "<H", 0x0218))
    case.bench.finish()
    assert case.bench.alarm_ids == [900035, 900005]
    assert "excess temperature" in case.bench.channel.alarms[1].values["emcy"]


@pytest.mark.long
def test_an_emergency_that_says_error_reset_is_no_alarm(trouble: Any) -> None:
    case = trouble()
    case.other.send_message(EMCY, bytes(8))
    case.bench.finish()
    assert case.bench.alarm_ids == []


@pytest.mark.long
@pytest.mark.provokes(900081, 7, axis="Z", pdo="TPDO1", cycles=4)
def test_900081_for_a_statusword_of_no_state(trouble: Any) -> None:
    case = trouble()
    case.change(TPDO1, _alter(0, "<H", 0x0001))
    alarm = case.only_alarm(5)
    assert (alarm.id, alarm.values["pdo"]) == (900081, "TPDO1")


@pytest.mark.long
@pytest.mark.provokes(900027, 7, axis="Z", state="READY_TO_SWITCH_ON")
def test_900027_when_somebody_takes_the_drive_out_of_operation(trouble: Any) -> None:
    case = trouble()
    case.change(RPDO1, _alter(0, "<H", 0x0006))
    alarm = case.only_alarm(3)
    assert alarm.id == 900027
    assert alarm.values["state"] == "READY_TO_SWITCH_ON"


@pytest.mark.long
@pytest.mark.provokes(900028, 7, axis="Z", pdo="TPDO1", length=6, expected=8)
def test_900028_for_a_telegram_that_does_not_fit(trouble: Any) -> None:
    case = trouble()
    case.change(TPDO1, lambda frame: Alter(frame.data[:6]), count=1)
    alarm = case.only_alarm(2)
    assert alarm.id == 900028
    assert alarm.values == {"axis": "Z", "pdo": "TPDO1", "length": 6, "expected": 8}


@pytest.mark.long
@pytest.mark.provokes(900029, 7, axis="Z")
def test_900029_for_a_position_that_jumps(trouble: Any) -> None:
    """v_max 500 mm/s: 0.5 mm per cycle, twice that is credible."""
    case = trouble()
    case.change(TPDO1, _alter(2, "<i", 0), count=1)
    alarm = case.only_alarm(2)
    assert alarm.id == 900029
    assert float(alarm.values["jump_mm"]) == pytest.approx(16.0, abs=3.0)
    # 2 is the quick stop of 6040, 0 keeps Z off when it stands: Y follows its targets and is braked
    assert case.controlwords_behind_the_alarm == {0x2, 0x0}
    assert case.controlwords(RPDO1 - 1) == {0xF}


@pytest.mark.long
def test_900005_when_set_positions_do_not_reach_the_drive(trouble: Any) -> None:
    """The drive watches its RPDO (1400:5) and reacts by 6007; 8250 tells why."""
    case = trouble(start_up=StartUpSettings(rpdo_timeout_ms=5))
    case.change(RPDO1, lambda _frame: Drop())
    alarm = case.only_alarm(10)
    assert alarm.id == 900005
    assert "0x8250, RPDO has timed out" in str(alarm)


@pytest.mark.long
@pytest.mark.provokes(900036, 7, axis="Z", limit_mm=2)
def test_900036_when_the_lag_is_beyond_the_limit_of_the_rig(trouble: Any) -> None:
    """Running at 40 mm/s with kv 40 1/s the axis is 1 mm behind; the drive stands, so it grows."""
    case = trouble(lag_limit_mm=2.0)
    case.change(RPDO1, lambda _frame: Drop())
    alarm = case.only_alarm(60)
    assert alarm.id == 900036
    assert 2.0 < abs(float(alarm.values["lag_mm"])) < 2.1


@pytest.mark.long
@pytest.mark.provokes(900030, 7)
def test_900030_when_the_kernels_controller_goes_bus_off(trouble: Any) -> None:
    """32 errors of its own telegrams: 32 * 8 > 255."""
    case = trouble()
    case.change(RPDO1, lambda _frame: ErrorAtBit(60), count=32)
    alarm = case.only_alarm(6)
    assert alarm.id in (900030, 900031)
    case = trouble()
    case.change(0x080, lambda _frame: ErrorAtBit(20), count=32)
    assert case.only_alarm(6).id == 900030


@pytest.mark.long
@pytest.mark.provokes(900031, 7)
def test_900031_when_the_bus_takes_no_sync(trouble: Any) -> None:
    case = trouble()
    for _ in range(40):  # 5 ms of a node that sends without pause
        case.other.send_message(0x001, bytes(8))
    assert case.only_alarm(2).id == 900031


def test_a_sync_counter_runs_from_one_to_its_end(channel_bench: Make, words: Any) -> None:
    """CiA 301, object 1019: the counter begins with 1 and starts over behind its overflow value."""
    bench = channel_bench(words.axis("Z"), sync_counter=5)
    bench.run([words.move(1, 3000.0, Z=2.0), words.end()])
    counted = [data for _, can_id, data in bench.frames if can_id == 0x080]
    assert bench.alarm_ids == []
    assert counted[:7] == [bytes((n,)) for n in (1, 2, 3, 4, 5, 1, 2)]


# Node guarding


def _guarding(life_factor: int = 2) -> dict[str, Any]:
    watch = WatchSettings(guard_ns=10 * MS, life_factor=life_factor)
    start_up = StartUpSettings(guard_time_ms=10, life_factor=life_factor)
    return {"start_up": start_up, "watches": (watch, watch)}


@pytest.mark.long
def test_node_guarding_is_answered_with_a_toggle(trouble: Any) -> None:
    """CiA 301 section 7.2.8.3.2.1: bit 7 alternates, the rest is the NMT state."""
    case = trouble(**_guarding())
    case.bench.finish()
    assert case.bench.alarm_ids == []
    start_ns = case.bench.channel.start_ns
    said = [data[0] for t, i, data in case.bench.frames if i == HEARTBEAT and data and t > start_ns]
    assert len(said) > 10
    assert set(said) == {0x05, 0x85}
    assert all(a != b for a, b in pairwise(said))


@pytest.mark.long
def test_node_guarding_asks_for_as_many_bytes_as_the_answer_has(trouble: Any) -> None:
    """CAN 2.0: the data length code of a remote frame is that of the frame that it asks for."""
    case = trouble(**_guarding())
    seen: list[tuple[bool, int]] = []
    case.change(HEARTBEAT, lambda frame: seen.append((frame.is_remote_frame, frame.dlc)))
    case.bench.finish()
    assert set(seen) == {(True, 1), (False, 1)}


@pytest.mark.long
def test_900023_when_node_guarding_is_not_answered(trouble: Any) -> None:
    case = trouble(**_guarding())
    case.change(HEARTBEAT, lambda frame: Drop() if frame.data else None)
    alarm = case.only_alarm(32)
    assert (alarm.id, alarm.values["what"]) == (900023, "node guarding")


@pytest.mark.long
def test_900023_when_the_toggle_bit_stands_still(trouble: Any) -> None:
    case = trouble(**_guarding())
    case.change(HEARTBEAT, lambda frame: Alter(b"\x05") if frame.data else None)
    alarm = case.only_alarm(32)
    assert (alarm.id, alarm.values["what"]) == (900023, "node guarding")


# Heartbeat


def _heartbeat(**options: Any) -> dict[str, Any]:
    watch = WatchSettings(heartbeat_ns=20 * MS)
    return {"start_up": StartUpSettings(heartbeat_ms=10), "watches": (watch, watch), **options}


@pytest.mark.provokes(900023, 7, axis="Z", node=2, what="heartbeat", ms=20)
@pytest.mark.long
def test_900023_when_the_heartbeat_stops(trouble: Any) -> None:
    case = trouble(**_heartbeat())
    case.change(HEARTBEAT, lambda _frame: Drop())
    alarm = case.only_alarm(22)
    assert alarm.id == 900023
    assert alarm.values["what"] == "heartbeat"


@pytest.mark.long
def test_a_regular_heartbeat_is_no_alarm(trouble: Any) -> None:
    case = trouble(**_heartbeat())
    case.bench.finish()
    assert case.bench.alarm_ids == []


@pytest.mark.long
@pytest.mark.provokes(900034, 7, axis="Z", state="pre-operational")
def test_900034_when_a_drive_is_made_pre_operational(trouble: Any) -> None:
    case = trouble(**_heartbeat(missing_cycles=100))
    case.other.send_message(0, bytes((128, Z)))
    alarm = case.only_alarm(12)
    assert alarm.id == 900034
    assert alarm.values["state"] == "pre-operational"
