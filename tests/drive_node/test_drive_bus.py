"""The node on the bus: foreign masters, PDO bytes by hand, NMT, events, refusals."""

import struct
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from canopen.profiles.p402 import BaseNode402
from canopen.sdo.exceptions import SdoAbortedError, SdoCommunicationError

from axisrig.bench.bus.can.canopen_sim import SimRemoteNode
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]


class Node402(SimRemoteNode, BaseNode402):
    """canopen's own 402 master; only its waiting is in simulated time."""


def code_of(write: Callable[[], None]) -> int:
    with pytest.raises(SdoAbortedError) as caught:
        write()
    return int(caught.value.code)


# Foreign masters


def test_canopen_402_master_enables_by_pdo(drive_bench: Make) -> None:
    bench = drive_bench(remote=Node402)
    remote = bench.remote
    remote.setup_402_state_machine()
    remote.nmt.state = "OPERATIONAL"
    bench.master.sync.start(0.001)
    remote.rpdo[1].start(0.001)
    assert remote.op_mode == "CYCLIC SYNCHRONOUS POSITION"
    remote.state = "OPERATION ENABLED"
    assert bench.node.state is State.OPERATION_ENABLED
    assert bench.axis.commands[-1].enabled
    remote.state = "SWITCH ON DISABLED"
    assert bench.node.state is State.SWITCH_ON_DISABLED
    assert not bench.axis.commands[-1].enabled


def test_canopen_master_enables_by_sdo_alone(drive_bench: Make) -> None:
    """Pre-operational, no PDO: the statuswords of the walk are read over SDO."""
    bench = drive_bench()
    sdo = bench.remote.sdo
    words = [sdo[0x6041].raw]
    for word in (0x06, 0x07, 0x0F):
        sdo[0x6040].raw = word
        words.append(sdo[0x6041].raw)
    assert words == [0x0250, 0x0231, 0x0233, 0x1237]
    assert bench.axis.commands[-1].enabled  # without any SYNC


def test_canopen_codec_decodes_the_telegram(drive_bench: Make, fake_axis: Any) -> None:
    bench = drive_bench(fake_axis(start_m=-0.005))
    bench.remote.tpdo.read()
    bench.operational(40)
    bench.sync_at_ms(50)
    pdo = bench.remote.tpdo[1]
    assert [(entry.index, entry.raw) for entry in pdo] == [
        (0x6041, 0x0250), (0x6064, -524_288), (0x60B9, 0)]  # fmt: skip


# PDO bytes


def test_rpdo1_and_tpdo1_byte_by_byte(drive_bench: Make, fake_axis: Any) -> None:
    """1 mm = 104858 increments = 0x0001999A; the target acts on the axis, the word on 60B9."""
    bench = drive_bench(fake_axis(start_m=0.001), ([], []))
    bench.operational()
    bench.master.send_message(0x203, bytes.fromhex("0600 FEFFFFFF 1121"))
    bench.sync_at_ms(3)
    assert bench.frames(0x183) == [bytes.fromhex("3102 9A990100 0101")]
    assert bench.frames(0x283) == [bytes.fromhex("00000000")]
    assert bench.remote.sdo[0x607A].raw == -2
    assert bench.remote.sdo[0x60B8].raw == 0x2111
    assert bench.remote.sdo[0x6040].raw == 6


def test_received_values_wait_for_the_sync_and_the_last_one_counts(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.operational()
    bench.set_values(0x06, 1)
    bench.set_values(0x00, 2)
    bench.run_to_ms(2.95)
    assert bench.node.image.target_position == 0
    bench.sync_at_ms(3)
    assert bench.node.image.target_position == 2
    assert bench.node.state is State.SWITCH_ON_DISABLED


def test_answer_comes_right_after_the_sync(drive_bench: Make) -> None:
    """At most 135 and 95 bit with the intermissions; lower bound without any stuff bit."""
    bench = drive_bench()
    bench.operational()
    bench.sync_at_ms(3)
    (first,), (second,) = bench.times_ns(0x183), bench.times_ns(0x283)
    assert 3_051_000 + 108_000 <= first <= 3_051_000 + 132_000
    assert 79_000 <= second - first <= 95_000


def test_short_rpdo_is_dropped_with_an_emergency_once(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.operational()
    bench.master.send_message(0x203, bytes.fromhex("060001000000"))
    bench.master.send_message(0x203, bytes.fromhex("060001000000"))
    bench.sync_at_ms(3)
    assert bench.node.state is State.SWITCH_ON_DISABLED
    assert bench.frames(0x083) == [bytes.fromhex("1082110100000000")]
    bench.set_values(0x06, 0)
    bench.sync_at_ms(4)
    assert bench.frames(0x083)[1:] == [bytes(8)]
    assert bench.node.state is State.READY_TO_SWITCH_ON


def test_transmission_types_n_and_0(drive_bench: Make, fake_axis: Any) -> None:
    """TPDO1 every third SYNC, TPDO2 (type 0) with a SYNC when its data has changed."""
    bench = drive_bench(fake_axis(start_m=0.01), ([9_500_000], None))
    bench.remote.sdo[0x1800][2].raw = 3
    bench.remote.sdo[0x1801][2].raw = 0
    bench.operational(4)
    bench.set_values(0, 0, function=0x0011)
    for k in range(5, 14):
        bench.sync_at_ms(k)
    assert [t // MS for t in bench.times_ns(0x183)] == [7, 10, 13]
    assert [t // MS for t in bench.times_ns(0x283)] == [5, 10]


def test_remapping_while_operational(drive_bench: Make, fake_axis: Any) -> None:
    """TPDO4 gets 60F4 and 6064 in the order of the standard; RPDO2 acts without SYNC."""
    bench = drive_bench(fake_axis(start_m=0.001))
    bench.operational()
    sdo = bench.remote.sdo
    sdo[0x1A03][1].raw = 0x60F40020
    sdo[0x1A03][2].raw = 0x60640020
    sdo[0x1A03][0].raw = 2
    sdo[0x1803][2].raw = 1
    sdo[0x1803][1].raw = 0x483
    sdo[0x1601][1].raw = 0x60400010
    sdo[0x1601][0].raw = 1
    sdo[0x1401][1].raw = 0x303
    bench.run_to_ms(19.5)
    bench.master.send_message(0x303, b"\x06\x00")
    bench.run_to_ms(19.9)
    assert bench.node.state is State.READY_TO_SWITCH_ON
    bench.sync_at_ms(20)
    assert bench.frames(0x483) == [bytes.fromhex("00000000 9A990100")]
    sdo[0x1803][1].raw = 0x80000483
    bench.sync_at_ms(30)
    assert len(bench.frames(0x483)) == 1


# Events


def test_digital_inputs_at_start_and_on_change(drive_bench: Make) -> None:
    """60FD: bit 16 probe input 1, bit 17 probe input 2; seen at the SYNC after the edge."""
    bench = drive_bench(inputs=([5_500_000, 9_500_000], [7_500_000]))
    bench.operational(3)
    for k in range(4, 12):
        bench.sync_at_ms(k)
    assert bench.frames(0x383) == [
        bytes.fromhex(f"0000{bits}00") for bits in ("00", "01", "03", "02")
    ]
    assert [t // MS for t in bench.times_ns(0x383)] == [3, 6, 8, 10]


def test_inhibit_time_delays_a_change_and_drops_what_came_back(drive_bench: Make) -> None:
    """Inhibit 5 ms: sent at the start (4.4 ms), then at 9.4 and 14.4 ms.

    High is seen at 8 and held until 9.4; low is seen at 10 and held until 14.4; high is seen at
    16, but at 17 the level is the one sent last: nothing at 19.4.
    """
    bench = drive_bench(inputs=([7_500_000, 9_500_000, 15_500_000, 16_500_000], None))
    sdo = bench.remote.sdo
    sdo[0x1802][1].raw = 0x80000383
    sdo[0x1802][3].raw = 50
    sdo[0x1802][1].raw = 0x383
    bench.operational(4.3)
    for k in range(5, 22):
        bench.sync_at_ms(k)
    assert [frame[2] for frame in bench.frames(0x383)] == [0, 1, 0]
    times = bench.times_ns(0x383)
    assert times[0] // MS == 4
    for earlier, later in pairwise(times):
        # requests are 5 ms apart; the frames differ by stuff bits
        assert abs(later - earlier - 5 * MS) < 10_000


def test_change_held_by_the_inhibit_time_is_lost_with_its_pdo(drive_bench: Make) -> None:
    """High is seen at 5 and held until 7.3; at 6.6 the PDO is taken out of use."""
    bench = drive_bench(inputs=([4_500_000], None))
    sdo = bench.remote.sdo
    sdo[0x1802][1].raw = 0x80000383
    sdo[0x1802][3].raw = 40
    sdo[0x1802][1].raw = 0x383
    bench.operational(3.3)
    bench.sync_at_ms(5)
    bench.sync_at_ms(6)
    sdo[0x1802][1].raw = 0x80000383
    bench.run_to_ms(10)
    assert len(bench.frames(0x383)) == 1


def test_start_tells_the_level_of_now(drive_bench: Make) -> None:
    """The edge came before the start and no SYNC has ever come."""
    bench = drive_bench(inputs=([1_500_000], None))
    bench.operational(3)
    assert bench.frames(0x383) == [bytes.fromhex("00000100")]


def test_statusword_as_event_follows_an_sdo_command_at_once(drive_bench: Make) -> None:
    bench = drive_bench()
    sdo = bench.remote.sdo
    sdo[0x1A03][1].raw = 0x60410010
    sdo[0x1A03][0].raw = 1
    sdo[0x1803][1].raw = 0x483
    bench.operational(4)
    sdo[0x6040].raw = 0x06
    bench.run_to_ms(5)
    assert bench.frames(0x483) == [b"\x50\x02", b"\x31\x02"]


# NMT, heartbeat


def test_boot_up_is_the_first_frame(drive_bench: Make) -> None:
    bench = drive_bench()
    assert [(can_id, data) for _, can_id, data in bench.heard] == [(0x703, b"\x00")]


def test_no_pdo_before_start_and_after_stop(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.set_values(0x06, 7)
    bench.sync_at_ms(2)
    assert bench.frames(0x183) == []
    assert bench.node.image.target_position == 0
    bench.operational(3)
    bench.sync_at_ms(4)
    bench.remote.nmt.send_command(128)
    bench.set_values(0x06, 7)
    bench.sync_at_ms(6)
    assert len(bench.frames(0x183)) == 1
    assert bench.remote.sdo[0x607A].raw == 0
    bench.master.send_message(0x203, b"\x06\x00")  # too short, but nobody is listening
    bench.run_to_ms(12)
    assert bench.frames(0x083) == []


def test_stopped_node_answers_nothing_but_nmt(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.remote.nmt.send_command(2)
    with pytest.raises(SdoCommunicationError):
        _ = bench.remote.sdo[0x1000].raw
    bench.remote.nmt.send_command(1)
    assert bench.remote.sdo[0x1000].raw == 0x00020192


@pytest.mark.parametrize(("command", "window"), [(129, 0xFFFF_FFFF), (130, 2500)])
def test_reset_brings_defaults_and_the_boot_up(
    drive_bench: Make, command: int, window: int
) -> None:
    """Reset node restores all objects, reset communication only 1000 to 1FFF.

    To an axis that was enabled the second is a lost connection: fault (6007).
    """
    bench = drive_bench()
    bench.remote.sdo[0x6065].raw = 2500
    bench.remote.sdo[0x1006].raw = 4000
    bench.remote.sdo[0x1800][2].raw = 5
    bench.operational(10)
    bench.enable(11)
    bench.remote.nmt.send_command(command)
    bench.run_to_ms(15)
    assert bench.frames(0x703) == [b"\x00", b"\x00"]
    assert bench.remote.sdo[0x6065].raw == window
    assert bench.remote.sdo[0x1006].raw == 0
    assert bench.remote.sdo[0x1800][2].raw == 1
    assert bench.node.state is not State.OPERATION_ENABLED
    assert not bench.axis.commands[-1].enabled
    assert [frame[:2] for frame in bench.frames(0x083)] == ([b"\x30\x81"] if command == 130 else [])
    count = len(bench.frames(0x183))
    bench.sync_at_ms(30)
    assert len(bench.frames(0x183)) == count


def test_command_for_another_node_is_ignored(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.master.send_message(0, b"\x01\x04")
    bench.sync_at_ms(2)
    assert bench.frames(0x183) == []
    bench.master.send_message(0, b"\x01\x00")
    bench.sync_at_ms(3)
    assert len(bench.frames(0x183)) == 1


def test_heartbeat_tells_the_nmt_state(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.remote.sdo[0x1017].raw = 10
    begin = len(bench.frames(0x703))
    bench.operational(15)
    bench.run_to_ms(41)
    beats = bench.times_ns(0x703)[begin:]
    for earlier, later in pairwise(beats[1:]):
        assert abs(later - earlier - 10 * MS) < 10_000  # stuff bits differ by the state
    assert bench.frames(0x703)[-1] == b"\x05"
    assert bench.remote.nmt.state == "OPERATIONAL"


def test_sync_identifier_follows_1005(drive_bench: Make) -> None:
    bench = drive_bench()
    bench.remote.sdo[0x1005].raw = 0x81
    bench.operational(3)
    bench.sync_at_ms(4)
    assert bench.frames(0x183) == []
    bench.master.send_message(0x81, b"")
    bench.run_to_ms(5)
    assert len(bench.frames(0x183)) == 1
    bench.remote.nmt.send_command(129)
    bench.operational(6)
    bench.sync_at_ms(7)
    assert len(bench.frames(0x183)) == 2


# Refusals, by the abort codes of CiA 301


@pytest.mark.parametrize(
    ("index", "sub", "value", "code"),
    [
        (0x1006, 0, 99, 0x06090030),
        (0x1006, 0, 1_000_001, 0x06090031),
        (0x1600, 0, 9, 0x06090031),
        (0x6060, 0, 2, 0x06090030),
        (0x60B8, 0, 0x001D, 0x06090030),
        (0x60D0, 1, 3, 0x06090030),
        (0x1005, 0, 0x40000080, 0x06090030),
        (0x6041, 0, 0, 0x06010002),
        (0x6502, 0, 0, 0x06010002),
    ],
)
def test_refused_values(drive_bench: Make, index: int, sub: int, value: int, code: int) -> None:
    bench = drive_bench()
    sdo = bench.remote.sdo
    entry = sdo[index][sub] if sub or index == 0x1600 else sdo[index]
    if index == 0x1600:
        sdo[0x1400][1].raw = 0x80000203
    assert code_of(lambda: setattr(entry, "raw", value)) == code


def test_refused_accesses(drive_bench: Make) -> None:
    sdo = drive_bench().remote.sdo
    assert code_of(lambda: sdo.upload(0x6073, 0)) == 0x06020000
    assert code_of(lambda: sdo.upload(0x1018, 5)) == 0x06090011
    assert code_of(lambda: sdo.download(0x607A, 0, b"\x01\x00")) == 0x06070013


def test_limits_themselves_are_taken(drive_bench: Make) -> None:
    sdo = drive_bench().remote.sdo
    for value in (0, 100, 1_000_000):
        sdo[0x1006].raw = value
        assert sdo[0x1006].raw == value
    sdo[0x6060].raw = 8
    assert sdo[0x6061].raw == 8


@pytest.mark.parametrize(
    ("index", "sub", "value", "code"),
    [
        (0x1A03, 1, 0x60FD0004, 0x06040041),  # four bits: the next entry would not be aligned
        (0x1A03, 1, 0x60400010, 0x06040041),  # controlword is not for TPDOs
        (0x1A03, 1, 0x10060020, 0x06040041),
        (0x1A03, 1, 0x60730010, 0x06020000),
        (0x1A03, 1, 0x60640120, 0x06090011),
        (0x1A03, 1, 0x10180520, 0x06090011),
        (0x1601, 1, 0x60410010, 0x06040041),  # statusword is not for RPDOs
        (0x1A03, 0, 1, 0x06020000),  # entry 1 is empty
        (0x1800, 1, 0x184, 0x06090030),  # identifier of a valid PDO
        (0x1803, 1, 0x583, 0x06090030),  # identifier of the SDO
        (0x1803, 1, 0x20000483, 0x06090030),
        (0x1803, 2, 250, 0x06090030),
        (0x1802, 3, 20, 0x06090030),  # inhibit time of a valid PDO
        (0x1A00, 1, 0x60640020, 0x06010000),  # entry of a valid PDO
        (0x1A00, 0, 0, 0x06010000),
    ],
)
def test_refused_pdo_parameters(
    drive_bench: Make, index: int, sub: int, value: int, code: int
) -> None:
    sdo = drive_bench().remote.sdo
    assert code_of(lambda: setattr(sdo[index][sub], "raw", value)) == code


def test_a_mapping_beyond_8_byte_is_refused(drive_bench: Make) -> None:
    sdo = drive_bench().remote.sdo
    for sub in (1, 2, 3):
        sdo[0x1A03][sub].raw = 0x60640020
    assert code_of(lambda: setattr(sdo[0x1A03][0], "raw", 3)) == 0x06040042
    sdo[0x1A03][0].raw = 2
    assert code_of(lambda: setattr(sdo[0x1A03][1], "raw", 0x60F40020)) == 0x06010000


def test_sdo_reads_what_is_now(drive_bench: Make, fake_axis: Any) -> None:
    """No SYNC has ever come; the position read is that of the instant of the answer."""
    bench = drive_bench(fake_axis(motion=lambda t: 0.1 * t))
    bench.run_to_ms(100)
    value = struct.unpack("<i", bench.remote.sdo.upload(0x6064, 0))[0]
    now_mm = 0.1 * bench.scheduler.now_ns * 1e-6
    assert now_mm - 0.1 * 0.2 < value / 104857.6 < now_mm


@pytest.mark.parametrize("sub", [1, 2])
def test_either_source_of_a_probe_takes_the_numbers_that_the_drive_has(
    drive_bench: Make, sub: int
) -> None:
    """60D0: inputs 1 and 2, zero pulses 5 and 6."""
    bench = drive_bench()
    for value in (1, 2, 5, 6):
        bench.remote.sdo[0x60D0][sub].raw = value
    for value in (0, 3, 4, 7, -1):
        with pytest.raises(SdoAbortedError) as caught:
            bench.remote.sdo[0x60D0][sub].raw = value
        assert caught.value.code == 0x06090030
    assert bench.remote.sdo[0x60D0][sub].raw == 6
