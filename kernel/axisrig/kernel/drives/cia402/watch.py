"""Watches over a drive of CiA 402 while a program runs, whatever carries its words."""

from typing import Final

from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.interface import DriveWatch
from axisrig.kernel.drives.position_watch import lag_alarm
from axisrig.kernel.drives.power import Power, PowerRequest
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.emergency import Emergency

# An emergency comes before the status word that explains it: so many cycles are waited for that
EMERGENCY_CYCLES: Final = 2


class Cia402Watch(DriveWatch):
    """What the words of a drive say of its condition."""

    def __init__(self, drive: Cia402Drive) -> None:
        self._drive = drive
        self._emergency_cycles = 0

    def condition(self) -> Alarm | None:
        """Return what is wrong with the drive itself, None when nothing is.

        Alarm 900005 (fault), 900036 and 900037 (lag), 900025 or 900035 (emergency), 900027 (has
        left operation enabled).
        """
        drive = self._drive
        if drive.request is PowerRequest.STOP:
            return None  # as it was commanded
        if drive.power is Power.OPERATING and drive.emergency is None:
            return lag_alarm(drive)
        word = f"0x{drive.statusword:04X}"
        if drive.power is Power.FAULT:
            self._emergency_cycles = 0
            return drive.fault()
        if drive.emergency is not None:
            return self._judge(drive.emergency)
        return Alarm(900027, axis=drive.name, statusword=word, state=drive.state_name)

    def _judge(self, emergency: Emergency) -> Alarm | None:
        """Wait for the status word that explains an emergency, then take it for itself."""
        self._emergency_cycles += 1
        if self._emergency_cycles < EMERGENCY_CYCLES:
            return None
        self._emergency_cycles, self._drive.emergency = 0, None
        if emergency.reaction == "warn":
            return Alarm(900035, axis=self._drive.name, emcy=str(emergency))
        return Alarm(900025, axis=self._drive.name, emcy=str(emergency))
