"""CoE of a slave: which service goes where. Source: docs/ethercat.md."""

import struct
from collections.abc import Callable, Mapping
from typing import Final

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.bench.drive.ethercat.coe import SdoServer
from axisrig.bench.drive.ethercat.mailbox import Mailbox, MailboxService
from axisrig.bench.drive.ethercat.object_access import ObjectAccess
from axisrig.bench.drive.ethercat.object_information import ObjectInformation
from axisrig.bench.drive.ethercat.objects import Described
from axisrig.kernel.profiles.ethercat.layouts import (
    COE,
    COE_EMERGENCY,
    CoeService,
    MailboxType,
)

_SERVICE_SHIFT: Final = 12
_INFO_BYTES: Final = 5


class CoeServer(MailboxService):
    """Serves CoE. size(): bytes of the mailbox to the master."""

    def __init__(
        self,
        store: ObjectStore,
        known: Mapping[int, Described],
        profile: DriveProfile,
        size: Callable[[], int],
    ) -> None:
        self.kind = MailboxType.COE
        self._sdo = SdoServer(ObjectAccess(store, known), size)
        self._information = ObjectInformation(
            known, profile, lambda index: len(store.upload(index, 0)), size
        )

    def reset(self) -> None:
        """Drop what is under way."""
        self._sdo.reset()

    def serve(self, body: bytes) -> list[bytes]:
        """Return the answers to a message, all from the CoE head on."""
        service = COE.unpack_from(body)[0] >> _SERVICE_SHIFT
        if service == CoeService.SDO_REQUEST:
            answer = self._sdo.request(body)
            return [answer] if answer else []
        if service == CoeService.SDO_INFORMATION:
            return self._information.request(body)
        return []

    @staticmethod
    def emergency(mailbox: Mailbox, code: int, register: int, info: int) -> None:
        """Send an emergency message. info: first of the bytes that are the device's own."""
        own = struct.pack("B", info).ljust(_INFO_BYTES, b"\x00")
        head = COE.pack(CoeService.EMERGENCY << _SERVICE_SHIFT)
        mailbox.send(MailboxType.COE, head + COE_EMERGENCY.pack(code, register, own))
