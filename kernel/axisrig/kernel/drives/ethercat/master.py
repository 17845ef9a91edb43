"""The control as master of one segment: its cyclic frame, and what comes back of it.

Each cycle one frame: the time of the master to the reference clock (FPWR 0910), from there to all
others (FRMW 0910), the process image (LRW), the states of all slaves (BRD 0130), and where time
stamps are compared with their clocks how far these are from the time that they get (BRD 092C).
Inputs are taken only with the right working counter, and only of the frame of their own cycle.
"""

from collections.abc import Callable, Sequence
from typing import Final

from axisrig.kernel.drives.ethercat.clocks import AMOUNT_MASK, TIME_MASK, distribution
from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE, Datagram, frame_of
from axisrig.kernel.drives.ethercat.image import LOGICAL, Image
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPort
from axisrig.kernel.drives.ethercat.port import EthercatPort
from axisrig.kernel.drives.ethercat.settings import LineSettings, RegisterInputs, SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import Silent, SlaveData
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.layouts import (
    DATAGRAM,
    DATAGRAM_DATA_MAX,
    FIRST_DATAGRAM,
    SM_FULL,
    WORKING_COUNTER,
)
from axisrig.kernel.profiles.ethercat.tables import AlState, Command, address_of
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

FIRST_INDEX: Final = 0x80
INDICES: Final = 0x80
"""Indices of the cyclic frames: from 0x80 to 0xFF, in turn."""
NEVER: Final[TimeNs] = -1
OP: Final = int(AlState.OP)
_DIFFERENCE: Final = address_of("SYSTEM_TIME_DIFFERENCE")


class Cyclic:
    """The cyclic frame as bytes, and where in it the parts are. image_bytes: of the LRW.

    reads_differences: it has the BRD of the clocks.
    """

    def __init__(
        self, reference: int | None, image_bytes: int, *, reads_differences: bool = False
    ) -> None:
        parts = [] if reference is None else distribution(reference, 0)
        parts += [
            Datagram(Command.LRW, LOGICAL, bytes(image_bytes)),
            Datagram(Command.BRD, address_of("AL_STATUS") << 16, bytes(2)),
        ]
        of_image = len(parts) - 2
        if reads_differences:
            parts.append(Datagram(Command.BRD, _DIFFERENCE << 16, bytes(4)))
        assert image_bytes <= DATAGRAM_DATA_MAX, "the rig has been checked"
        places, at = list[int](), FIRST_DATAGRAM
        for part in parts:
            places.append(at)
            at += DATAGRAM.size + len(part.data) + WORKING_COUNTER.size
        self.frame = frame_of(parts, FIRST_INDEX)
        self._heads = places
        self.time = None if reference is None else places[0] + DATAGRAM.size
        self.image = places[of_image] + DATAGRAM.size
        self.image_counter = self.image + image_bytes
        self.states = places[of_image + 1] + DATAGRAM.size
        self.states_counter = self.states + 2
        self.differences = places[-1] + DATAGRAM.size if reads_differences else None

    def index(self, number: int) -> None:
        """Give all datagrams an index."""
        for place in self._heads:
            self.frame[place + 1] = number


class Master:
    """One segment. data, mailboxes: of its drives, in their order on the line. others: behind them.
    count: of all slaves.

    others_taken: called for each of `others` with what a frame has brought of it.

    al_states: of all slaves, ORed, as the last frame of a cycle brought it, None when it did not
    or when not each slave has answered; answered: how many have. silent_cycles: in a row without a
    frame that came back. sent_ns: when the last cyclic frame left. taken_ns: that whose inputs were
    taken last.
    clocks_off_ns: how far clocks were apart at most from the inputs before to these.
    falls: called when a slave is not in OP while the cycles run.
    """

    def __init__(
        self,
        port: EthercatPort,
        clock: Clock,
        line: LineSettings,
        slaves: Sequence[SlaveSettings],
        data: Sequence[SlaveData],
        others: Sequence[RegisterInputs] = (),
    ) -> None:
        self._port, self._clock, self.line, self.slaves = port, clock, line, slaves
        self.transactions = Transactions(port, clock)
        self.others = list(others)
        self.count = len(self.slaves) + len(self.others)
        self.others_taken: list[Callable[[bytes], None]] = []
        self.image = Image(slaves, self.others)
        self._parts = list(zip(data, self.image.places, strict=True))
        self.mailboxes: list[MailboxPort] = []
        self.frames = 0
        self.silent_cycles = 0
        self.sent_ns = self.taken_ns = NEVER
        self.al_states: int | None = None
        self.answered = 0
        self.falls: list[Callable[[], None]] = []
        self._cyclic: Cyclic | None = None
        self._index = FIRST_INDEX
        self._is_back = True
        self._runs_alone = False
        self._at_ns: TimeNs = 0  # of the next cycle that begins by itself
        self.clocks_off_ns = self._apart_ns = 0

    # The cycle

    def prepare(self, reference: int | None) -> None:
        """Make the cyclic frame. reference: station of the reference clock, None = no clocks."""
        follows = reference if self.line.compensates_drift else None
        reads = self.line.reads_differences and follows is not None
        self._cyclic = Cyclic(follows, self.image.size, reads_differences=reads)

    def run_alone(self) -> None:
        """Send the cyclic frame from the next cycle on, until `cycle` is called instead."""
        self._runs_alone = True
        period_ns = self.line.period_ns
        self._at_ns = -(-(self._clock.now_ns + 1) // period_ns) * period_ns
        self._clock.call_at(self._at_ns, Phase.APPLICATION, self._alone)

    def stop(self) -> None:
        """Send no more by itself."""
        self._runs_alone = False
        self.transactions.is_held = False

    def _alone(self) -> None:
        if self._runs_alone:
            self._plan()
            self._at_ns += self.line.period_ns
            self._clock.call_at(self._at_ns, Phase.APPLICATION, self._alone)

    def cycle(self) -> None:
        """Send the cyclic frame of the cycle that begins now."""
        if not self._runs_alone:
            self._plan()
        elif self.sent_ns < self._clock.now_ns:
            self._runs_alone = False
            self._plan()
        else:
            self._runs_alone = False

    def _plan(self) -> None:
        if self.line.frame_ns:
            due_ns = self._clock.now_ns + self.line.frame_ns
            self._clock.call_at(due_ns, Phase.APPLICATION, self._send)
        else:
            self._send()

    def _send(self) -> None:
        cyclic = self._cyclic
        assert cyclic is not None, "the start-up has made it"
        was_lost = not self._is_back
        if was_lost:
            self.silent_cycles += 1
        self._index = (self._index + 1 - FIRST_INDEX) % INDICES + FIRST_INDEX
        cyclic.index(self._index)
        frame = cyclic.frame
        now_ns = self._clock.now_ns
        if cyclic.time is not None:
            frame[cyclic.time : cyclic.time + 4] = (now_ns & TIME_MASK).to_bytes(4, "little")
        for data, place in self._parts:
            data.forget()
            at = cyclic.image + place.outputs
            frame[at : at + place.output_bytes] = data.outputs
        self.transactions.is_held, self._is_back = True, False
        self.sent_ns, self.al_states = now_ns, None
        self.frames += 1
        self._port.send(bytes(frame))
        if was_lost:
            self.transactions.let_go()

    def image_in(self, frame: bytes) -> int | None:
        """Return where the process image begins in a cyclic frame, None where it counts for none.

        That is with a wrong working counter.
        """
        cyclic = self._cyclic
        if cyclic is None or len(frame) < len(cyclic.frame):
            return None
        (counter,) = WORKING_COUNTER.unpack_from(frame, cyclic.image_counter)
        return cyclic.image if counter == self.image.counter else None

    def received(self, frame: bytes) -> None:
        """Take a frame that is back; a cyclic one of an earlier cycle counts as lost."""
        if frame[INDEX_PLACE] < FIRST_INDEX:
            self.transactions.received(frame)
        elif frame[INDEX_PLACE] == self._index and not self._is_back:
            self._take(frame)

    def _take(self, frame: bytes) -> None:
        cyclic = self._cyclic
        assert cyclic is not None
        self._is_back, self.silent_cycles = True, 0
        if cyclic.differences is not None:
            self._note_clocks(frame, cyclic.differences)
        (counter,) = WORKING_COUNTER.unpack_from(frame, cyclic.image_counter)
        image, expected = cyclic.image, self.image.counter
        if counter == expected:
            self.taken_ns = self.sent_ns
            self.clocks_off_ns, self._apart_ns = self._apart_ns, 0
            for data, place in self._parts:
                begin = image + place.inputs
                data.arrived(frame[begin : begin + place.input_bytes])
            for number, taken in enumerate(self.others_taken):
                begin = image + self.image.registers[number]
                taken(frame[begin : begin + self.others[number].size])
        else:
            for data, _ in self._parts:
                data.refused(counter, expected)
        at = cyclic.states_counter
        answered = frame[at] | frame[at + 1] << 8
        self.answered = answered
        if answered == self.count:
            self.al_states = frame[cyclic.states]
        if self.al_states != OP:
            for note in self.falls:
                note()
        for number, (_, place) in enumerate(self._parts):
            if frame[image + place.mailbox] & SM_FULL:
                self.mailboxes[number].note_full()
        self.transactions.let_go()

    def note_silent(self, number: int | None) -> None:
        """Take note which slave does not answer, from 0 on; None: each does."""
        silent = None
        if number is not None:
            drives = len(self.slaves)
            slave = self.slaves[number] if number < drives else self.others[number - drives]
            silent = Silent(slave.axis, slave.node_id, self.answered, self.count)
        for data, _ in self._parts:
            data.silent = silent

    def _note_clocks(self, frame: bytes, at: int) -> None:
        """Note how far clocks are apart: by the slaves, and by how much later the time came.

        The slaves OR their amounts, so that what comes is at least the largest and less than twice
        that. A frame that takes longer than the shortest one has brought an older time.
        """
        later_ns = self.transactions.way.later_ns(self.sent_ns, self._clock.now_ns, len(frame))
        apart_ns = int.from_bytes(frame[at : at + 4], "little") & AMOUNT_MASK
        self._apart_ns = max(self._apart_ns, apart_ns + later_ns)
