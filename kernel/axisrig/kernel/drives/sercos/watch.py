"""Watches over a SERCOS drive while a program runs: the state of its slave and its words."""

from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.interface import DriveWatch
from axisrig.kernel.drives.position_watch import jump_alarm, lag_alarm
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.tables import AL_ERROR, AlState


class SercosWatch(DriveWatch):
    """The watch over one drive; begins with `begin`, asked once per cycle."""

    def __init__(self, drive: SercosDrive, carrier: EthercatCarrier) -> None:
        self._drive, self._carrier = drive, carrier
        self._has_warned = False  # of phase 0

    def begin(self) -> None:
        """Watch from now on; what came during the start-up does not count."""
        self._drive.begin()
        self._has_warned = False
        self._carrier.watch(self._drive.name)

    def end(self) -> None:
        """Ask no more."""
        self._carrier.watch_no_more()

    def communication(self) -> Alarm | None:
        """Return what is wrong with the connection, None when nothing is.

        Alarm 900732 (its slave is not in OP; where it is in INIT with the warning 140029), 900029
        (its position has jumped).
        """
        drive = self._drive
        fallen = self._carrier.fallen(drive.name)
        if fallen is not None:
            status = self._carrier.slaves[drive.name].status
            if status in (AlState.INIT, AlState.INIT | AL_ERROR) and not self._has_warned:
                self._has_warned = True
                drive.warn(Alarm(140029, axis=drive.name, state=AlState.INIT.name))
            return fallen
        return jump_alarm(drive)

    def condition(self) -> Alarm | None:
        """Return what is wrong with the drive itself, None when nothing is.

        Alarm 900005 (error of class 1), 900036 (lag), 900027 (has left operation).
        """
        drive = self._drive
        if drive.request is PowerRequest.STOP:
            return None
        if drive.power is Power.OPERATING:
            return lag_alarm(drive)
        if drive.power is Power.FAULT:
            return drive.fault()
        return Alarm(
            900027, axis=drive.name, statusword=f"0x{drive.status:04X}", state=drive.state_name
        )
