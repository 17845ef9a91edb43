"""The service channel of a slave over its mailbox."""

from typing import Final

from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPort
from axisrig.kernel.drives.sercos.service_channel import ServiceChannel
from axisrig.kernel.profiles.ethercat.layouts import MailboxType
from axisrig.kernel.time.clock import MS, Clock, TimeNs

LATER_NS: Final[TimeNs] = 100 * MS
"""The port gives up first: it knows whether the slave has taken the message."""


class ServiceMailbox:
    """Joins both. channel: what reads and writes idents."""

    def __init__(self, port: MailboxPort, clock: Clock, timeout_ns: TimeNs) -> None:
        self.port = port
        self.channel = ServiceChannel(
            lambda parts: port.send(MailboxType.SOE, parts),
            clock,
            lambda: port.room,
            timeout_ns + LATER_NS,
        )
        port.taken, port.silent = self._taken, self.channel.give_up

    def _taken(self, kind: int, body: bytes) -> None:
        before = self.channel.requests
        if kind == MailboxType.ERROR and self.port.waits:
            self.port.waits = False
            self.channel.give_up()
        elif kind == MailboxType.SOE:
            self.channel.take(body)
            if self.channel.requests == before and not self.channel.is_busy:
                self.port.waits = False
