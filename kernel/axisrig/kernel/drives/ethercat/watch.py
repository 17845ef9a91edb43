"""Watches over a drive on EtherCAT while a program runs: the state of its slave and its words."""

from axisrig.kernel.drives.cia402.watch import Cia402Watch
from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.link import EthercatLink
from axisrig.kernel.drives.position_watch import jump_alarm
from axisrig.kernel.errors import Alarm


class EthercatWatch(Cia402Watch):
    """The watch over one drive; begins with `begin`, asked once per cycle."""

    def __init__(self, link: EthercatLink, carrier: EthercatCarrier) -> None:
        super().__init__(link)
        self._link, self._carrier = link, carrier

    def begin(self) -> None:
        """Watch from now on; what came during the start-up does not count."""
        self._link.begin()
        self._carrier.watch(self._link.name)

    def end(self) -> None:
        """Ask no more."""
        self._carrier.watch_no_more()

    def communication(self) -> Alarm | None:
        """Return what is wrong with the connection, None when nothing is.

        Alarm 900732 (its slave is not in OP), 900029 (its position has jumped).
        """
        fallen = self._carrier.fallen(self._link.name)
        if fallen is not None:
            return fallen
        return jump_alarm(self._link)
