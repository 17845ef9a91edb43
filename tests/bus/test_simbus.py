"""The python-can face of a segment."""

import os
import subprocess
import sys
import threading
import tomllib
from pathlib import Path

import can
import pytest

from axisrig.bench.bus.can.frame import data_frame, frame_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

ROOT = Path(__file__).resolve().parents[2]

OPEN_BY_NAME = """
import can
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler
with Segment("can1", 250_000, new_scheduler()) as segment:
    with can.Bus(interface="axisrig", channel="can1", bitrate=250_000) as bus:
        print(type(bus).__name__, bus.segment is segment, bus.port_name)
    print(segment.ports)
"""


@pytest.mark.long
def test_python_can_finds_the_interface_by_its_entry_point(tmp_path: Path) -> None:
    """An installed distribution is imitated from the project's own pyproject.toml."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = tmp_path / "axisrig-0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: axisrig\nVersion: 0\n")
    points = project["entry-points"]["can.interface"]
    lines = ["[can.interface]", *(f"{name} = {target}" for name, target in points.items())]
    (info / "entry_points.txt").write_text("\n".join(lines))
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", OPEN_BY_NAME],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    assert done.stdout.splitlines() == ["SimBus True port1", "()"], done.stderr


def test_wrong_channel_bit_rate_or_queue_is_refused(segment: Segment) -> None:
    with pytest.raises(can.CanInitializationError, match=r"no open segment 'nowhere'; open: bus"):
        SimBus("nowhere")
    with pytest.raises(can.CanInitializationError, match="1000000 bit/s, not 500000"):
        SimBus("bus", bitrate=500_000)
    with pytest.raises(can.CanInitializationError, match="1000000 bit/s, not 2000000"):
        SimBus("bus", bitrate=2_000_000)
    with pytest.raises(can.CanInitializationError, match="fifo, mailbox"):
        SimBus("bus", queue="stack")  # type: ignore[arg-type]
    assert segment.ports == ()


def test_recv_advances_simulated_time_to_the_frame(segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    sender.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=[1, 2]))
    received = receiver.recv()
    assert received is not None
    assert (received.arbitration_id, bytes(received.data)) == (0x123, b"\x01\x02")
    assert received.channel == "bus"
    assert segment.now_ns == 1000 * (frame_bits(data_frame(0x123, b"\x01\x02")) - 3)
    assert received.timestamp == segment.now_ns / 1e9


def test_recv_times_out_in_simulated_time_with_traffic_that_is_filtered_out(
    segment: Segment,
) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    receiver.set_filters([{"can_id": 0x100, "can_mask": 0x700, "extended": False}])
    sender.send_periodic(can.Message(arbitration_id=0x200, is_extended_id=False), 0.001)
    assert receiver.recv(0.05) is None
    assert segment.now_ns == 50 * MS
    sender.send_raw(0x1FF, b"")
    received = receiver.recv(0.05)
    assert received is not None
    assert received.arbitration_id == 0x1FF


def test_filter_also_holds_for_callbacks(scheduler: Scheduler, segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    seen: list[int] = []
    receiver.attach_data(lambda can_id, data, timestamp: seen.append(can_id))
    receiver.set_filters([{"can_id": 0x80, "can_mask": 0x7FF}])
    for can_id in (0x80, 0x81):
        sender.send_raw(can_id, b"")
    scheduler.run_until(MS)
    assert seen == [0x80]


def test_recv_inside_an_event_only_polls(scheduler: Scheduler, segment: Segment) -> None:
    port = segment.port("only")
    polled: list[can.Message | None] = []
    scheduler.call_at(1, Phase.APPLICATION, lambda: polled.append(port.recv(0)))
    scheduler.run_until(2)
    assert polled == [None]
    scheduler.call_at(3, Phase.APPLICATION, lambda: port.recv(0.1))
    with pytest.raises(RuntimeError, match="must not wait"):
        scheduler.run_until(4)


def test_recv_is_refused_when_callbacks_take_the_frames(segment: Segment) -> None:
    port = segment.port("only")
    port.attach(lambda msg: None)
    with pytest.raises(RuntimeError, match="callbacks"):
        port.recv(0)


@pytest.mark.parametrize("way", ["recv", "attach"])
@pytest.mark.parametrize("disturbed", [False, True])
def test_own_frames_that_a_port_asks_for_say_that_it_has_sent_them(
    segment: Segment, way: str, disturbed: bool
) -> None:
    """`is_rx` of python-can: False for those, True for what others send, there and everywhere."""
    own = segment.port("own", receive_own_messages=True)
    other, third = segment.port("other"), segment.port("third")
    if disturbed:
        segment.add_fault(lambda _frame, _port, _attempt: None)
    heard: list[can.Message] = []
    if way == "attach":
        own.attach(heard.append)
    for remote in (False, True):
        for port, can_id in ((own, 0x100), (other, 0x200)):
            port.send(
                can.Message(
                    arbitration_id=can_id + remote, is_remote_frame=remote, is_extended_id=False
                )
            )
    segment.scheduler.run_until(MS)
    while (message := own.recv(0) if way == "recv" else None) is not None:
        heard.append(message)
    found = [(message.arbitration_id, message.is_rx) for message in heard]
    assert found == [(0x100, False), (0x101, False), (0x200, True), (0x201, True)]
    assert len({id(message) for message in heard}) == 4
    for can_id in (0x100, 0x101, 0x200, 0x201):
        message = third.recv(0)
        assert message is not None
        assert (message.arbitration_id, message.is_rx) == (can_id, True)
    assert [message.arbitration_id for message in iter(lambda: other.recv(0), None)] == [
        0x100,
        0x101,
    ]


def test_foreign_threads_are_refused(scheduler: Scheduler, segment: Segment) -> None:
    port = segment.port("only")
    errors: list[str] = []

    def foreign() -> None:
        for action in (lambda: port.recv(0), lambda: port.send_raw(1, b"")):
            try:
                action()
            except RuntimeError as error:
                errors.append(str(error))

    thread = threading.Thread(target=foreign)
    thread.start()
    thread.join()
    assert errors == ["a simulated bus belongs to the thread that made it"] * 2
    scheduler.run_until(MS)
    assert segment.load().frames == 0


def test_cyclic_sending_keeps_its_period_without_drift_and_without_a_thread(
    scheduler: Scheduler, segment: Segment
) -> None:
    """First at once, then every 0.3 ms; a SYNC ends 48 us after its request."""
    threads = threading.active_count()
    sender, receiver = segment.port("sender"), segment.port("receiver")
    times: list[int] = []
    receiver.attach(lambda msg: times.append(segment.now_ns))
    task = sender.send_periodic(can.Message(arbitration_id=0x80, is_extended_id=False), 0.0003)
    scheduler.run_until(300 * MS)
    assert times == [k * 300_000 + 48_000 for k in range(1000)]
    task.stop()
    scheduler.run_until(400 * MS)
    assert len(times) == 1001  # the one requested at 300 ms itself
    assert threading.active_count() == threads


def test_cyclic_messages_take_turns_change_and_end(scheduler: Scheduler, segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    data: list[int] = []
    receiver.attach(lambda msg: data.append(msg.data[0]))
    messages = [can.Message(arbitration_id=5, is_extended_id=False, data=[n]) for n in (1, 2)]

    def double(msg: can.Message) -> None:
        msg.data[0] *= 2

    task = sender.send_periodic(messages, 0.001, duration=0.004, modifier_callback=double)
    scheduler.run_until(10 * MS)
    assert data == [2, 4, 4, 8]
    data.clear()
    task.start()
    task.modify_data([can.Message(arbitration_id=5, data=[n]) for n in (7, 9)])
    scheduler.run_until(20 * MS)
    assert data == [14, 18, 28, 36]


def test_a_cyclic_task_that_starts_over_begins_with_its_first_message(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Also while it runs; sent at 0, 1 and 2 ms, then from 2.5 ms on."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    data: list[int] = []
    receiver.attach(lambda msg: data.append(msg.data[0]))
    messages = [can.Message(arbitration_id=5, is_extended_id=False, data=[n]) for n in (1, 2, 3, 4)]
    task = sender.send_periodic(messages, 0.001)
    scheduler.run_until(2_500_000)
    task.start()  # type: ignore[attr-defined]
    scheduler.run_until(4 * MS)
    assert data == [1, 2, 3, 1, 2]
    task.stop()
    scheduler.run_until(10 * MS)
    assert data == [1, 2, 3, 1, 2]


def test_a_wait_of_no_time_takes_none(scheduler: Scheduler, segment: Segment) -> None:
    """Whether anything comes later or not; time stands still."""
    port = segment.port("only")
    scheduler.call_at(5 * MS, Phase.APPLICATION, lambda: None)
    for timeout_s in (0, 0.0, -1.0):
        assert port.run_while(lambda: True, timeout_s) is False
        assert segment.now_ns == 0
    assert port.run_while(lambda: True, 0.002) is False
    assert segment.now_ns == 2 * MS


def test_cyclic_period_must_be_positive(segment: Segment) -> None:
    port = segment.port("only")
    with pytest.raises(ValueError, match="period"):
        port.send_periodic(can.Message(), 0.0)


@pytest.mark.parametrize(
    "msg",
    [
        can.Message(is_fd=True),
        can.Message(is_error_frame=True),
        can.Message(arbitration_id=0x800, is_extended_id=False),
        can.Message(arbitration_id=0x20000000),
        can.Message(data=bytes(9)),
        can.Message(data=b"\x00", dlc=2),
    ],
)
def test_what_a_classical_controller_cannot_send_is_refused(
    segment: Segment, msg: can.Message
) -> None:
    with pytest.raises(ValueError, match=r"sent|outside|data bytes|dlc"):
        segment.port("only").send(msg)


def test_raw_data_is_checked(segment: Segment) -> None:
    port = segment.port("only")
    with pytest.raises(ValueError, match="9 data bytes"):
        port.send_raw(1, bytes(9))
    with pytest.raises(ValueError, match=r"identifier -0x1 is outside 0\.\.0x1fffffff"):
        port.send_raw(-1, b"")


def test_flush_discards_what_has_not_won_yet(scheduler: Scheduler, segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    for value in range(3):
        sender.send_raw(0x100, bytes([value]))
    scheduler.call_at(1000, Phase.APPLICATION, sender.flush_tx_buffer)
    scheduler.run_until(MS)
    received = receiver.recv(0)
    assert received is not None
    assert received.data == b"\x00"
    assert receiver.recv(0) is None


def test_remote_frame_keeps_its_dlc(segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    receiver_data: list[int] = []
    segment.port("data").attach_data(lambda can_id, *_: receiver_data.append(can_id))
    sender.send(
        can.Message(arbitration_id=0x701, is_extended_id=False, is_remote_frame=True, dlc=1)
    )
    received = receiver.recv(1.0)
    assert received is not None
    assert (received.is_remote_frame, received.dlc, bytes(received.data)) == (True, 1, b"")
    assert receiver_data == []
