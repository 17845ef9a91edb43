"""The service channel of a slave over its mailbox."""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPort
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.drives.sercos.service_channel import ServiceChannel
from axisrig.kernel.profiles.ethercat.layouts import MailboxType
from axisrig.kernel.time.clock import MS, Clock, TimeNs

LATER_NS: Final[TimeNs] = 100 * MS
"""The port gives up first: it knows whether the slave has taken the message."""


class ServiceMailbox:
    """Joins both. channel: what reads and writes idents. port: carries them."""

    def __init__(
        self, transactions: Transactions, clock: Clock, station: int, timeout_ns: TimeNs
    ) -> None:
        self.port = MailboxPort(transactions, clock, station, timeout_ns, self._taken, self._silent)
        self.channel = ServiceChannel(
            self._send, clock, lambda: self.port.room, timeout_ns + LATER_NS
        )

    def _send(self, parts: Sequence[bytes]) -> None:
        self.port.send(MailboxType.SOE, parts)

    def _silent(self) -> None:
        self.channel.give_up()

    def _taken(self, kind: int, body: bytes) -> None:
        before = self.channel.requests
        if kind == MailboxType.ERROR and self.port.waits:
            self.port.end()
            self.channel.give_up()
        elif kind == MailboxType.SOE:
            self.channel.take(body)
            if self.channel.requests == before and not self.channel.is_busy:
                self.port.end()
