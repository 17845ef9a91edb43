"""The watch over a PROFIdrive drive while a program runs."""

from axisrig.kernel.drives.interface import DriveWatch
from axisrig.kernel.drives.position_watch import jump_alarm, lag_alarm
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.drives.profidrive.link import ProfidriveDrive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive.words import encoder_error_text


class ProfidriveWatch(DriveWatch):
    """The watch over one drive."""

    def __init__(self, drive: ProfidriveDrive) -> None:
        self._drive = drive

    def begin(self) -> None:
        """Nothing was noted before."""

    def end(self) -> None:
        """Nothing is asked beside the cycle."""

    def communication(self) -> Alarm | None:
        """Return Alarm 900029 for a position that has jumped."""
        return jump_alarm(self._drive)

    def condition(self) -> Alarm | None:
        """Return what is wrong with the drive itself, None when nothing is.

        Alarm 900005 (fault), 900763 (encoder interface), 900036 and 900037 (lag), 900027 (has left
        operation).
        """
        drive = self._drive
        if drive.request is PowerRequest.STOP:
            return None
        if drive.power is Power.FAULT:
            return drive.fault()
        if (code := drive.encoder_error) is not None:
            text = encoder_error_text(code)
            return Alarm(900763, axis=drive.name, code=code, meaning=text)
        if drive.power is Power.OPERATING:
            return lag_alarm(drive)
        return drive.left_operation()
