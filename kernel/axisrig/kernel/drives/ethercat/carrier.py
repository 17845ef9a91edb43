"""EtherCAT as it carries the cycles of the control: one frame for all drives of a segment."""

from dataclasses import dataclass
from typing import Final

from axisrig.kernel.drives.carrier import Carrier
from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_position
from axisrig.kernel.drives.ethercat.master import NEVER, Master
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.tables import (
    AlState,
    Command,
    address_of,
    al_status_text,
    state_name,
)
from axisrig.kernel.time.clock import TimeNs

STATUS_BYTES: Final = 6  # AL status, two reserved, AL status code


@dataclass
class SlaveState:
    """What a slave says of itself, as asked for when not all were in OP.

    status, code: its AL status and AL status code; None: not asked, or in OP.
    """

    axis: str
    node_id: int
    status: int | None = None
    code: int = 0


class EthercatCarrier(Carrier):
    """One segment. slaves: with drives, by axis, in their order on the line."""

    def __init__(self, master: Master) -> None:
        self._master = master
        self.name = master.line.name
        self.slaves = {each.axis: SlaveState(each.axis, each.node_id) for each in master.slaves}
        self._is_watched = self._is_asking = False
        master.falls.append(self._ask)

    def begin_cycle(self) -> None:
        """Send the frame of this cycle."""
        self._master.cycle()

    @property
    def holds_back(self) -> bool:
        """A frame leaves at once: nobody else sends."""
        return False

    def late(self) -> Alarm:
        """Return the alarm of a frame that could not leave; there is none such."""
        raise AssertionError("a frame leaves at once")

    def check(self) -> Alarm | None:
        """What is wrong with a segment shows at its drives."""
        return None

    def watch(self, axis: str) -> None:
        """Ask for the state of slaves when not all are in OP, from now on."""
        self.slaves[axis].status = None
        self._is_watched = True

    def watch_no_more(self) -> None:
        """Ask no more."""
        self._is_watched = False

    def fallen(self, axis: str) -> Alarm | None:
        """Return Alarm 900732 where the slave of an axis is not in OP."""
        slave = self.slaves[axis]
        if slave.status is None or slave.status == AlState.OP:
            return None
        return Alarm(
            900732,
            axis=axis,
            position=slave.node_id,
            state=state_name(slave.status),
            code=al_status_text(slave.code),
        )

    def _ask(self) -> None:
        """Ask each slave for its state, at its place: one that was off has no station address."""
        if not self._is_watched or self._is_asking:
            return
        self._is_asking = True
        register = address_of("AL_STATUS")
        self._master.transactions.ask(
            [
                Datagram(Command.APRD, at_position(place, register), bytes(STATUS_BYTES))
                for place in range(len(self.slaves))
            ],
            self._note,
        )

    def _note(self, answers: list[Answer] | None) -> None:
        self._is_asking = False
        if answers is not None:
            self._master.note_silent(self._silent(answers))
        for slave, answer in zip(self.slaves.values(), answers or [], strict=False):
            if answer.counter == 1:
                slave.status = answer.data[0]
                slave.code = int.from_bytes(answer.data[4:6], "little")
                if slave.status == AlState.OP:
                    slave.status = None

    def _silent(self, answers: list[Answer]) -> int | None:
        """Return the first slave that does not answer, from 0 on, None where each does.

        One behind the drives is not asked: how many answer the read of all states shows it.
        """
        for number, answer in enumerate(answers):
            if answer.counter == 0:
                return number
        found = self._master.answered
        return found if len(answers) <= found < self._master.count else None

    def sampled_ns(self, axis: str) -> TimeNs:
        """Return when the control assumes that the position of this cycle is sampled.

        With SYNC0 the last one before the frame that is to bring it, and `sample_ns` after that.
        """
        master, line = self._master, self._master.line
        if master.sent_ns == NEVER or not line.has_clocks:
            return max(master.sent_ns - line.period_ns, 0)
        assumed_ns = line.shift_ns + line.sample_ns.get(axis, 0)
        behind_ns = (master.sent_ns - assumed_ns) % line.period_ns
        return master.sent_ns - (behind_ns or line.period_ns)
