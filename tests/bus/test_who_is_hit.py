"""Which frames and which controllers a fault of the wire hits, and whose counts it leaves alone."""

from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import Alter, Drop, ErrorAtBit, FaultAction, FrameFault
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, US, Phase

Hook = Callable[[Frame, Controller, int], FaultAction | None]


def _send(segment: Segment, port: can.BusABC, can_id: int, *, extended: bool = False) -> None:
    port.send(can.Message(arbitration_id=can_id, is_extended_id=extended, data=b"\x01\x02"))
    segment.scheduler.run_until(segment.now_ns + MS)


def test_who_misses_a_frame_counts_it_neither_as_received_nor_as_an_error(
    segment: Segment,
) -> None:
    """Six errors, then frames that one of two receivers does not get: it keeps its count."""
    sender, near, far = (segment.port(name) for name in ("sender", "near", "far"))
    for port in (near, far):
        port.attach_data(lambda _id, _data, _time: None)
    errors = [6]

    def hook(frame: Frame, port: Controller, attempt: int) -> FaultAction | None:
        if errors[0]:
            errors[0] -= 1
            return ErrorAtBit(20)
        return Drop(frozenset({"far"})) if frame.arbitration_id == 0x200 else None

    segment.add_fault(hook)
    _send(segment, sender, 0x100)
    assert (sender.tec, near.rec, far.rec) == (47, 5, 5)  # 6 errors, and the frame got through
    for number in range(1, 4):
        _send(segment, sender, 0x200)
        assert (sender.tec, near.rec, far.rec) == (47 - number, 5 - number, 5)
    _send(segment, sender, 0x100)
    assert (near.rec, far.rec) == (1, 4)


@pytest.mark.parametrize("of_it", ["drop", "alter"])
def test_a_fault_of_an_identifier_is_of_its_11_bits(segment: Segment, of_it: str) -> None:
    """The extended frame with the same number is another one."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    heard: list[tuple[int, bool, bytes]] = []
    receiver.attach(lambda m: heard.append((m.arbitration_id, m.is_extended_id, bytes(m.data))))
    if of_it == "drop":
        segment.add_fault(FrameFault(0x183))
    else:
        segment.add_fault(FrameFault(0x183, lambda frame, _: Alter(frame.data[::-1])))
    for can_id, extended in ((0x183, False), (0x183, True), (0x184, False)):
        _send(segment, sender, can_id, extended=extended)
    hit = [] if of_it == "drop" else [(0x183, False, b"\x02\x01")]
    assert heard == [*hit, (0x183, True, b"\x01\x02"), (0x184, False, b"\x01\x02")]


def test_a_frame_that_is_dropped_for_all_reaches_nobody_and_is_sent_once(segment: Segment) -> None:
    ports = [segment.port(name) for name in ("sender", "one", "two")]
    heard: list[int] = []
    for port in ports[1:]:
        port.attach_data(lambda can_id, _data, _time: heard.append(can_id))
    segment.add_fault(FrameFault(0x183))
    for can_id in (0x183, 0x184):
        _send(segment, ports[0], can_id)
    assert heard == [0x184, 0x184]
    assert [port.tec + port.rec for port in ports] == [0, 0, 0]
    assert segment.load().frames == 2


def _passive(*ports: Controller) -> None:
    """16 failed attempts: TEC 128."""
    for port in ports:
        for _ in range(16):
            port.errors.transmit_failed()
        port.update_state()
        assert port.error_state is ErrorState.PASSIVE


FAR = frozenset({"far"})


@pytest.mark.parametrize(
    ("action", "sent", "misses"),
    [(None, b"\x00", False), (Alter(b"\x07"), b"\x07", False), (Drop(FAR), b"\x00", True),
     (Drop(), b"\x00", True), (ErrorAtBit(20, FAR), b"\x00", True)],
)  # fmt: skip
def test_who_fails_in_silence_has_nothing_of_the_frame_whatever_else_hits_it(
    segment: Segment, action: FaultAction | None, sent: bytes, misses: bool
) -> None:
    """0x200 with data 00 and 01 at once: the second sender is passive and sees its own bit error.

    It sends again after the frame of the first, which nobody disturbs then.
    """
    ports = [segment.port(name) for name in ("low", "high", "near", "far")]
    low, high, near, far = ports
    _passive(low, high, far)
    heard: dict[str, list[bytes]] = {port.port_name: [] for port in ports}
    for port in ports:
        port.attach(lambda m, own=heard[port.port_name]: own.append(bytes(m.data)))
    segment.add_fault(lambda frame, port, attempt: action if port is low else None)
    low.send_raw(0x200, b"\x00")
    high.send_raw(0x200, b"\x01")
    segment.scheduler.run_until(MS)
    is_for_nobody = isinstance(action, Drop) and action.at is None
    first = [] if is_for_nobody else [sent]
    assert heard == {"low": [b"\x01"], "high": [], "near": [*first, b"\x01"],
                     "far": [*([] if misses else first), b"\x01"]}  # fmt: skip
    assert (low.tec, high.tec) == (127, 128 + 8 - 1)
    assert (near.rec, far.rec) == (0, 0)


@pytest.mark.parametrize(("seer", "is_destroyed"), [("one", True), ("two", True), ("far", False)])
def test_an_error_that_any_sender_sees_is_seen_by_all(
    segment: Segment, seer: str, is_destroyed: bool
) -> None:
    """All that could see it are passive: only a flag within one's own frame breaks its stuffing."""
    one, two, far, near = (segment.port(name) for name in ("one", "two", "far", "near"))
    _passive(one, two, far)
    segment.add_fault(
        lambda _frame, _port, attempt: None if attempt else ErrorAtBit(20, frozenset({seer}))
    )
    for port in (one, two):
        port.send_raw(0x200, b"\x05")
    segment.scheduler.run_until(MS)
    assert segment.load().error_frames == is_destroyed
    assert [near.recv(0) is not None, near.recv(0) is not None] == [True, False]
    assert (far.recv(0) is not None) is is_destroyed


@pytest.mark.parametrize("at_us", [21, 25, 27, 33])
@pytest.mark.parametrize("by", ["power_off", "force_bus_off"])
def test_an_error_frame_ends_as_it_began_whatever_becomes_of_its_sender(
    segment: Segment, at_us: int, by: str
) -> None:
    """Error at bit 20: flag of 6 and delimiter of 8 bits, so that it ends after 34 us."""
    sender, near = segment.port("sender"), segment.port("near")
    ends: list[tuple[int, bool]] = []
    segment.observe(lambda time_ns, _segment, _frame, is_error: ends.append((time_ns, is_error)))
    segment.add_fault(lambda _frame, _port, _attempt: ErrorAtBit(20))
    sender.send_raw(0x200, b"\x05")
    segment.scheduler.call_at(at_us * 1000, Phase.APPLICATION, getattr(sender, by))
    segment.scheduler.run_until(MS)
    assert ends == [(34_000, True)]
    assert (near.rec, segment.load().busy_bits) == (1, 34 + 3)


@pytest.mark.parametrize("active", [(), ("one",), ("two",), ("one", "two"), ("low",)])
def test_one_error_active_sender_that_sees_its_bit_error_destroys_the_frame_of_all(
    segment: Segment,
    naive_wire: Callable[[int, bytes, bool, bool, int], str],
    active: tuple[str, ...],
) -> None:
    """0x200 with data 00, 01 and 01 at once: the last two see dominant where they send recessive.

    The flag of an active one has 6 dominant bits after that bit, those of the others and the
    delimiter take 6 + 8 bits more. The frame ends as it is where both are passive, whatever the
    first sender is, and the two send on after it.
    """
    ports = {name: segment.port(name) for name in ("low", "one", "two", "near")}
    senders = [ports[name] for name in ("low", "one", "two")]
    _passive(*(port for port in senders if port.port_name not in active))
    before = [port.tec for port in senders]
    ends: list[tuple[int, bool]] = []
    segment.observe(lambda time_ns, _segment, _frame, is_error: ends.append((time_ns, is_error)))
    for port, data in zip(senders, (b"\x00", b"\x01", b"\x01"), strict=True):
        port.send_raw(0x200, data)
    texts = [naive_wire(0x200, data, False, False, 1) for data in (b"\x00", b"\x01")]
    bit = next(at for at, pair in enumerate(zip(*texts, strict=False), 1) if len({*pair}) == 2)
    is_destroyed = "one" in active or "two" in active
    segment.scheduler.run_until((bit + 6 + 6 + 8) * US if is_destroyed else 100 * US)
    near = ports["near"].recv(0)
    if is_destroyed:
        assert ends == [((bit + 6 + 6 + 8) * US, True)]
        assert near is None
        assert [port.tec for port in senders] == [tec + 8 for tec in before]
    else:
        assert ends == [((len(texts[0]) + 10) * US, False)]
        assert near is not None
        assert bytes(near.data) == b"\x00"
        assert [port.tec for port in senders] == [max(before[0] - 1, 0), 128 + 8, 128 + 8]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_passive_senders_fall_out_one_after_the_other(
    segment: Segment, order: tuple[int, int, int]
) -> None:
    """0x200 with data 00, 01 and 02 at once: 02 differs from 00 one bit before 01 does.

    Nobody disturbs the frame with 00; each of the others gets none of it, counts 8 and sends after
    it, where 01 wins against 02 in the same way.
    """
    senders = [segment.port(f"data {number}") for number in range(3)]
    near = segment.port("near")
    _passive(*senders)
    heard: list[list[bytes]] = [[] for _ in senders]
    for port, own in zip(senders, heard, strict=True):
        port.attach(lambda m, own=own: own.append(bytes(m.data)))
    for number in order:
        senders[number].send_raw(0x200, bytes((number,)))
    segment.scheduler.run_until(2 * MS)
    found = [near.recv(0) for _ in range(4)]
    assert [bytes(m.data) for m in found if m is not None] == [b"\0", b"\1", b"\2"]
    assert heard == [[b"\1", b"\2"], [b"\2"], []]
    # 128 at first; each failure 8 more, each frame that got through or came 1 less of its count
    assert [port.tec for port in senders] == [127, 128 + 8 - 1, 128 + 16 - 1]
    assert segment.load().error_frames == 0
