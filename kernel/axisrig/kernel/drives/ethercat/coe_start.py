"""Sets up a drive of CiA 402 in PREOP: its objects, then which PDOs it has and what they carry."""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.drives.canopen.startup import StartUp
from axisrig.kernel.drives.cia402.objects import SdoError, object_name
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.ethercat.steps import (
    DriveSteps,
    Pause,
    ReadObject,
    Steps,
    WriteObject,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, TimeNs

POLL_NS: Final[TimeNs] = MS
ASSIGN_OUTPUTS, ASSIGN_INPUTS = 0x1C12, 0x1C13


class CoeSteps(DriveSteps):
    """One drive. objects: the start-up of its objects over SDO."""

    def __init__(self, settings: SlaveSettings, mailbox: Mailbox, objects: StartUp) -> None:
        self._settings, self._mailbox, self._objects = settings, mailbox, objects

    def in_preop(self) -> Steps:
        """Write the objects of the drive, then assignment and mapping. Raises Alarm."""
        found: list[Alarm | None] = []
        self._objects.begin(found.append)
        while not found:
            yield Pause(POLL_NS)
        if found[0] is not None:
            raise found[0]
        for assignment, pdos in (
            (ASSIGN_OUTPUTS, self._settings.outputs),
            (ASSIGN_INPUTS, self._settings.inputs),
        ):
            wrong = []
            for pdo in pdos:
                if not (yield from self._carries(pdo)):
                    wrong.append(pdo)
            assigned = yield from self._read_list(assignment, 2)
            wanted = [pdo.index for pdo in pdos]
            if wrong or assigned != wanted:
                yield from self._write(assignment, 0, 0, 1)
                for pdo in wrong:
                    entries = [mapped.entry for mapped in pdo.objects]
                    yield from self._write_list(pdo.index, entries, 4)
                yield from self._write_list(assignment, wanted, 2)

    def _carries(self, pdo: Pdo) -> Steps:
        entries = yield from self._read_list(pdo.index, 4)
        return entries == [mapped.entry for mapped in pdo.objects]

    def _read_list(self, index: int, size: int) -> Steps:
        count = yield from self._read(index, 0)
        entries = []
        for sub in range(1, count + 1):
            entries.append((yield from self._read(index, sub)) & (1 << 8 * size) - 1)
        return entries

    def _write_list(self, index: int, entries: Sequence[int], size: int) -> Steps:
        yield from self._write(index, 0, 0, 1)
        for sub, entry in enumerate(entries, 1):
            yield from self._write(index, sub, entry, size)
        yield from self._write(index, 0, len(entries), 1)

    def _read(self, index: int, sub: int) -> Steps:
        answer = yield ReadObject(self._mailbox, index, sub)
        if isinstance(answer, SdoError):
            raise self._refused(f"the reading of {object_name(index, sub)}", answer)
        return int.from_bytes(answer, "little")

    def _write(self, index: int, sub: int, value: int, size: int) -> Steps:
        data = value.to_bytes(size, "little")
        answer = yield WriteObject(self._mailbox, index, sub, data)
        if isinstance(answer, SdoError):
            what = f"PDOs: {object_name(index, sub)} = 0x{value:X}"
            raise self._refused(what, answer)

    def _refused(self, step: str, answer: SdoError) -> Alarm:
        settings = self._settings
        return Alarm(
            900011, axis=settings.axis, node=settings.node_id, step=step, answer=str(answer)
        )
