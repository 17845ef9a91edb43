"""The cyclic frames of a master, with a line that the test writes: what is sent, taken, and lost.

A datagram is command, index, address, length, interrupt, data, working counter (ETG.1000.4). LRW of
two drives counts to 6; the order is FPWR and FRMW of the time, LRW, BRD of the states, BRD of the
differences of clocks.
"""

import struct
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE, Datagram
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import LineSettings, Pdo, RegisterInputs, SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import SlaveData
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

FPWR, FRMW, LRW, BRD = 5, 14, 12, 7
OP, SAFEOP = 8, 4
FIRST, LAST = 0x80, 0xFF
FULL = 0x08  # of the status of a SyncManager: its mailbox


def pdo(*sizes: int) -> tuple[Pdo, ...]:
    objects = tuple(MappedObject(0x6000 + n, 0, bits, False, "") for n, bits in enumerate(sizes))
    return (Pdo(0x1600, objects),)


class Data(SlaveData):
    """Notes what the master calls."""

    def __init__(self, settings: SlaveSettings) -> None:
        super().__init__(settings)
        self.log: list[Any] = []

    def arrived(self, data: bytes) -> None:
        super().arrived(data)
        self.log.append(bytes(data))

    def refused(self, found: int, expected: int) -> None:
        super().refused(found, expected)
        self.log.append((found, expected))

    def forget(self) -> None:
        super().forget()
        self.log.append("forget")


class Line:
    """A master of drives X (2 bytes out, 1 in) and Y (1 out, 2 in), and a terminal T of 4 bytes."""

    def __init__(self, *, terminal: bool = False, **settings: Any) -> None:
        self.clock = new_scheduler()
        self.sent: list[tuple[int, bytes]] = []
        port: Any = SimpleNamespace(send=lambda frame: self.sent.append((self.clock.now_ns, frame)))
        slaves = [
            SlaveSettings(
                axis=axis, increments_per_mm=1.0, node_id=node,
                outputs=pdo(out_bits), inputs=pdo(in_bits),
            )
            for axis, node, out_bits, in_bits in (("X", 1, 16, 8), ("Y", 2, 8, 16))
        ]  # fmt: skip
        self.data = [Data(each) for each in slaves]
        others = [RegisterInputs(axis="T", node_id=3, first=0, size=4)] if terminal else []
        line = LineSettings(name="ec1", period_ns=MS, **settings)
        self.master = Master(port, self.clock, line, slaves, self.data, others)
        self.full: list[str] = []
        boxes: Any = [
            SimpleNamespace(note_full=lambda axis=axis: self.full.append(axis)) for axis in "XY"
        ]
        self.master.mailboxes = boxes
        self.terminal: list[bytes] = []
        if terminal:
            self.master.others_taken.append(self.terminal.append)
        self.fallen = 0
        self.master.falls.append(self.fall)
        self.master.prepare(1001)

    def fall(self) -> None:
        self.fallen += 1

    def cycle(self) -> bytes:
        """Begin the next cycle; return its frame."""
        self.clock.run_until(-(-(self.clock.now_ns + 1) // MS) * MS)
        self.master.cycle()
        return self.sent[-1][1]

    def back(
        self,
        frame: bytes,
        *,
        image: bytes = bytes(8),
        counter: int = 6,
        states: int = OP,
        answered: int = 2,
        apart_ns: int = 0,
    ) -> None:
        """Bring a frame back."""
        whole = bytearray(frame)
        for command, at, size in parts(frame):
            if command == LRW:
                whole[at : at + len(image)] = image
                struct.pack_into("<H", whole, at + size, counter)
            elif command == BRD and size == 2:
                whole[at] = states
                struct.pack_into("<H", whole, at + size, answered)
            elif command == BRD:
                struct.pack_into("<I", whole, at, apart_ns)
        self.master.received(bytes(whole))

    def logs(self) -> list[Any]:
        """The last call of each drive."""
        return [data.log[-1] for data in self.data]


def parts(frame: bytes) -> list[tuple[int, int, int]]:
    """Command, begin of the data and their length of each datagram."""
    found, at, more = [], 16, True
    while more:
        command, _, _, _, word, _ = struct.unpack_from("<BBHHHH", frame, at)
        size, more = word & 0x7FF, bool(word & 0x8000)
        found.append((command, at + 10, size))
        at += 12 + size
    return found


def indices(frame: bytes) -> set[int]:
    """The indices of the datagrams: each is the second byte of its 10 before the data."""
    return {frame[at - 9] for _, at, _ in parts(frame)}


@pytest.mark.parametrize(
    ("settings", "commands"),
    [
        ({}, [FPWR, FRMW, LRW, BRD]), ({"watches_clocks": True}, [FPWR, FRMW, LRW, BRD, BRD]),
        ({"compensates_drift": False, "watches_clocks": True}, [LRW, BRD]),
    ],
)  # fmt: skip
def test_a_frame_has_the_time_the_image_and_the_states(
    settings: dict[str, bool], commands: list[int]
) -> None:
    """Outputs of both, inputs of both, then a byte for each mailbox."""
    line = Line(**settings)
    line.data[0].outputs, line.data[1].outputs = b"\x01\x02", b"\x03"
    frame = line.cycle()
    assert [command for command, _, _ in parts(frame)] == commands
    at, size = next((at, size) for command, at, size in parts(frame) if command == LRW)
    assert frame[at : at + size] == b"\x01\x02\x03" + bytes(5)
    if FPWR in commands:
        at = parts(frame)[0][1]
        assert struct.unpack_from("<I", frame, at) == (line.clock.now_ns,)


def test_each_cycle_has_an_index_of_its_own_and_they_go_round() -> None:
    line = Line()
    of_cycles = [indices(line.cycle()) for _ in range(300)]
    assert all(len(each) == 1 for each in of_cycles)
    numbers = [each.pop() for each in of_cycles]
    assert set(numbers) == set(range(FIRST, LAST + 1))
    assert all((after - before) % 128 == 1 for before, after in pairwise(numbers))


def test_what_comes_back_is_taken_by_each_drive_once() -> None:
    line = Line()
    frame = line.cycle()
    image = bytes(3) + b"\x0a" + b"\x0b\x0c" + bytes(2)
    for _ in range(2):  # a second one of the same cycle counts for nothing
        line.back(frame, image=image)
        assert [data.log for data in line.data] == [["forget", b"\x0a"], ["forget", b"\x0b\x0c"]]
    assert (line.master.silent_cycles, line.master.al_states, line.fallen) == (0, OP, 0)
    assert line.master.taken_ns == line.master.sent_ns == line.sent[-1][0]


def test_a_frame_of_an_earlier_cycle_counts_as_lost() -> None:
    line = Line()
    late = line.cycle()
    frame = line.cycle()
    line.back(late)
    assert line.logs() == ["forget", "forget"]
    line.back(frame)
    assert line.logs() == [b"\0", b"\0\0"]


def test_frames_that_stay_out_in_a_row_are_counted() -> None:
    line = Line()
    for lost in range(4):
        frame = line.cycle()
        assert line.master.silent_cycles == lost
        assert line.master.al_states is None
    line.back(frame)
    assert line.master.silent_cycles == 0
    for lost in (0, 1):
        line.cycle()
        assert line.master.silent_cycles == lost


@pytest.mark.parametrize("counter", [0, 3, 5, 7])
def test_with_another_working_counter_no_input_counts(counter: int) -> None:
    """And what was taken before stays with its own instant."""
    line = Line()
    line.back(line.cycle())
    taken_ns = line.master.taken_ns
    frame = line.cycle()
    line.back(frame, counter=counter)
    assert line.logs() == [(counter, 6)] * 2
    assert line.master.taken_ns == taken_ns
    assert [data._data for data in line.data] == [None, None]


@pytest.mark.parametrize(
    ("states", "answered", "shown", "fallen"),
    [(OP, 2, OP, 0), (OP | SAFEOP, 2, OP | SAFEOP, 1), (OP, 1, None, 1), (OP, 3, None, 1)],
)
def test_a_slave_that_is_not_in_op_or_silent_is_noted_with_each_frame(
    states: int, answered: int, shown: int | None, fallen: int
) -> None:
    line = Line()
    for number in (1, 2):
        line.back(line.cycle(), states=states, answered=answered)
        assert (line.master.al_states, line.master.answered) == (shown, answered)
        assert line.fallen == number * fallen


@pytest.mark.parametrize(
    ("boxes", "full"),
    [
        ((0, 0), []), ((FULL, 0), ["X"]), ((0, FULL | 0x41), ["Y"]), ((FULL, FULL), ["X", "Y"]),
        ((0xFF & ~FULL, 1), []), ((0x30, FULL), ["Y"]),  # other bits say nothing of a message
    ],
)  # fmt: skip
def test_a_full_mailbox_is_that_of_its_drive(boxes: tuple[int, int], full: list[str]) -> None:
    line = Line()
    line.back(line.cycle(), image=bytes(6) + bytes(boxes))
    assert line.full == full


@pytest.mark.parametrize(
    ("counter", "missing", "is_there"),
    [(6, 0, True), (5, 0, False), (7, 0, False), (0, 0, False), (6, 1, False), (6, 40, False),
     (6, -4, True)],
)  # fmt: skip
def test_who_reads_along_finds_the_image_of_a_whole_frame_with_the_right_counter(
    counter: int, missing: int, is_there: bool
) -> None:
    """Behind both datagrams of the time, or first of all; a frame may be padded at its end."""
    line = Line()
    frame = bytearray(line.cycle())
    (_, at, size) = parts(bytes(frame))[2]
    struct.pack_into("<H", frame, at + size, counter)
    read = bytes(frame[:-missing]) if missing > 0 else bytes(frame) + bytes(-missing)
    assert line.master.image_in(read) == (at if is_there else None)
    begun = Line(has_clocks=False)
    begun.master.prepare(None)
    other = bytearray(begun.cycle())
    (command, at, size) = parts(bytes(other))[0]
    assert command == LRW
    struct.pack_into("<H", other, at + size, 6)
    assert begun.master.image_in(bytes(other)) == at


def test_a_terminal_behind_the_drives_has_its_part_and_counts_one_more() -> None:
    line = Line(terminal=True)
    line.back(line.cycle(), image=bytes(8) + b"\1\2\3\4", counter=7, answered=3)
    assert (line.terminal, line.master.al_states) == ([b"\1\2\3\4"], OP)
    line.back(line.cycle(), image=bytes(8) + b"\5\6\7\x08", counter=6, answered=3)
    assert line.terminal == [b"\1\2\3\4"]
    line.master.note_silent(2)
    assert {data.silent.axis for data in line.data if data.silent} == {"T"}
    line.master.note_silent(1)
    assert {(data.silent.axis, data.silent.position) for data in line.data if data.silent} == {
        ("Y", 2),
    }  # fmt: skip
    line.master.others.append(RegisterInputs(axis="U", node_id=4, first=0, size=1))
    for number, place in ((0, ("X", 1)), (2, ("T", 3)), (3, ("U", 4))):
        line.master.note_silent(number)
        found = [data.silent for data in line.data if data.silent]
        assert [(each.axis, each.position) for each in found] == [place] * 2
    line.master.note_silent(None)
    assert [data.silent for data in line.data] == [None, None]


def test_how_far_clocks_were_apart_is_the_most_since_the_inputs_before() -> None:
    """The sign is bit 31; a frame without its counter has shown its clocks all the same."""
    line = Line(watches_clocks=True)
    line.back(line.cycle(), apart_ns=70)
    assert line.master.clocks_off_ns == 70
    line.back(line.cycle(), apart_ns=1 << 31 | 500, counter=5)
    assert line.master.clocks_off_ns == 70
    line.back(line.cycle(), apart_ns=20)
    assert line.master.clocks_off_ns == 500
    line.back(line.cycle(), apart_ns=30)
    assert line.master.clocks_off_ns == 30


# Who begins the cycles


def test_before_the_channel_the_master_begins_the_cycles_by_itself() -> None:
    line = Line(frame_ns=200)
    line.clock.run_until(MS // 2)
    line.master.run_alone()
    line.clock.run_until(4 * MS - 1)
    assert [at for at, _ in line.sent] == [MS + 200, 2 * MS + 200, 3 * MS + 200]
    line.master.stop()
    line.clock.run_until(9 * MS)
    assert len(line.sent) == 3


@pytest.mark.parametrize("is_first", [True, False])
def test_the_first_cycle_of_the_channel_takes_the_place_of_one_of_the_master(
    is_first: bool,
) -> None:
    """In the same instant either of them may be first; there is one frame in it."""
    line = Line()
    line.master.run_alone()
    line.clock.run_until(3 * MS - 1)
    if is_first:
        line.clock.call_at(3 * MS, -1, line.master.cycle)
        line.clock.run_until(3 * MS)
    else:
        line.clock.run_until(3 * MS)
        line.master.cycle()
    assert [at for at, _ in line.sent] == [MS, 2 * MS, 3 * MS]
    for _ in range(2):
        line.cycle()
    assert [at for at, _ in line.sent][3:] == [4 * MS, 5 * MS]


def test_a_question_waits_for_the_cyclic_frame_and_not_for_ever() -> None:
    """It leaves behind the frame that is back, or with the next one where that was lost."""
    line = Line()
    line.cycle()
    line.master.transactions.ask([], lambda _: None)
    assert len(line.sent) == 1
    line.cycle()
    assert len(line.sent) == 3  # the first frame was lost
    assert max(indices(line.sent[2][1])) < FIRST


# After the cycles


QUESTION = [Datagram(Command.BRD, 0x0130 << 16, bytes(2))]


def questions(line: Line) -> list[bytes]:
    """The frames beside the cycle."""
    return [frame for _, frame in line.sent if max(indices(frame)) < FIRST]


@pytest.mark.parametrize("is_lost", [False, True])
def test_a_master_that_has_stopped_asks_at_once(is_lost: bool) -> None:
    """No cyclic frame comes back any more to let a question go."""
    line = Line()
    line.master.run_alone()
    line.clock.run_until(3 * MS)
    if not is_lost:
        line.back(line.sent[-1][1])
    line.master.stop()
    answers: list[Any] = []
    for _ in range(2):
        line.master.transactions.ask(QUESTION, answers.append)
    assert len(questions(line)) == 1
    line.master.received(questions(line)[-1])
    assert len(questions(line)) == 2
    line.master.received(questions(line)[-1])
    assert [len(each) for each in answers] == [1, 1]
    line.clock.run_until(9 * MS)
    assert len(questions(line)) == 2


def test_a_master_that_runs_again_holds_questions_back_again() -> None:
    line = Line()
    line.master.run_alone()
    line.clock.run_until(2 * MS)
    line.master.stop()
    line.clock.run_until(4 * MS + 1)
    line.master.run_alone()
    line.clock.run_until(5 * MS)
    line.master.transactions.ask(QUESTION, lambda _: None)
    assert questions(line) == []
    line.back(line.sent[-1][1])
    assert len(questions(line)) == 1


def test_questions_leave_one_behind_each_frame_that_is_back() -> None:
    line = Line()
    for _ in range(3):
        line.master.transactions.ask(QUESTION, lambda _: None)
    assert len(questions(line)) == 1  # before the first cycle nothing holds it
    for number in (1, 2, 3):
        frame = line.cycle()
        line.master.received(questions(line)[-1])
        assert len(questions(line)) == number
        line.back(frame)
        assert len(questions(line)) == min(number + 1, 3)


def test_what_is_asked_after_a_frame_is_back_leaves_behind_the_next_one() -> None:
    """Else it would keep the frame of the next cycle from the wire."""
    line = Line()
    line.back(line.cycle())
    line.master.transactions.ask(QUESTION, lambda _: None)
    assert questions(line) == []
    frame = line.cycle()
    assert (questions(line), line.sent[-1][1]) == ([], frame)
    line.back(frame)
    assert len(questions(line)) == 1


def test_a_question_without_an_answer_is_asked_three_times() -> None:
    """2 ms apart, each with an index of its own; what comes late counts for nothing."""
    line = Line()
    answers: list[Any] = []
    line.master.transactions.ask(QUESTION, answers.append)
    first = questions(line)[0]
    line.clock.run_until(20 * MS)
    assert [at for at, _ in line.sent] == [0, 2 * MS, 4 * MS]
    assert len({frame[INDEX_PLACE] for _, frame in line.sent}) == 3
    assert answers == [None]
    line.master.received(first)
    assert answers == [None]
