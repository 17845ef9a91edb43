"""The actual position of a drive of CiA 402 as its SDO server reports it."""

from typing import Final

from axisrig.kernel.drives.cia402.latch_check import StandstillRoom
from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError
from axisrig.kernel.drives.position_check import Answered, Ask

POSITION_ACTUAL: Final = 0x6064
BY_SDO: Final = "SDO (6064)"


def asked_by_sdo(sdo: ObjectAccess, room: StandstillRoom | None = None) -> Ask:
    """Return what asks a drive for 6064. room: None where each cycle has room for SDO."""

    def ask(answered: Answered) -> bool:
        if room is not None and not room.enter(waits_for_rest=False):
            return False

        def take(result: bytes | SdoError) -> None:
            if room is not None:
                room.leave()
            if isinstance(result, SdoError):
                answered(str(result))
            else:
                answered(int.from_bytes(result, "little", signed=True))

        sdo.read(POSITION_ACTUAL, 0, take)
        return True

    return ask
