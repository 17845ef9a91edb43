"""#DRIVE and #IDENT in a running program: values for drives, over SDO or in an RPDO.

Without WAIT a write runs in parallel to the program; an error of it comes up in the cycle in which
the drive's answer is there. Sources: TF5200 programming manual 207630987 (drive functions),
207347083 (idents, which go by SDO as acyclic functions do).
"""

from collections.abc import Mapping
from dataclasses import dataclass

from axisrig.kernel.drives.canopen.idents import DriveIdent, drive_idents
from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.cia402.objects import ObjectAccess, object_name
from axisrig.kernel.drives.function_accesses import FunctionAccesses
from axisrig.kernel.drives.functions import DriveFunction, Functions
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon


@dataclass(frozen=True)
class DriveAccess:
    """What #DRIVE needs of one axis: the ways to its drive and the functions of its list."""

    link: Cia402Drive
    sdo: ObjectAccess
    functions: Functions


class DriveFunctions(FunctionAccesses):
    """Carries out the #DRIVE commands of a channel; accesses: by axis."""

    def __init__(self, accesses: Mapping[str, DriveAccess]) -> None:
        super().__init__()
        self._accesses = accesses
        self._cyclic: list[str] = []  # axes whose RPDO is sent in this cycle

    def check(self) -> None:
        """Begin a cycle: raise what has gone wrong with a command that ran beside the program.

        What was sent with the RPDO of the cycle before has acted at the SYNC of this one.
        """
        if self._cyclic:
            self._open.subtract(self._cyclic)
            self._cyclic.clear()
        super().check()

    def start(self) -> None:
        """Give the cyclic objects the values they have from the start on (P-AXIS-00400)."""
        for access in self._accesses.values():
            for function in access.functions.values():
                if function.communication == "CYCLIC" and function.startup is not None:
                    access.link.set_object(function.index, function.sub, function.startup)

    def _carry_out(self, command: canon.DriveRead | canon.DriveWrite) -> None:
        if command.length_bytes is None:
            function = self._find(command.axis, command.key)
        else:
            function = self._ident(command.axis, command.key, command.length_bytes)
        if isinstance(command, canon.DriveRead):
            self._read(command, function)
        else:
            self._write(command, function)

    def _functions(self, axis: str) -> Functions:
        return self._accesses[axis].functions if axis in self._accesses else {}

    def _way(self, axis: str) -> ObjectAccess:
        return self._accesses[axis].sdo

    def _ident(self, axis: str, name: str, length_bytes: int) -> DriveIdent:
        if axis not in self._accesses:
            raise Alarm(900110, axis=axis, key=name, known="none")
        idents = drive_idents(self._accesses[axis].link.settings.increments_per_mm)
        found = idents.get(name)
        if found is None:
            raise Alarm(900255, axis=axis, ident=name, known=", ".join(idents))
        if length_bytes != found.length_bytes:
            allowed = f"{found.length_bytes} for {name}"
            raise Alarm(900256, keyword="TYP", value=f"{length_bytes}", allowed=allowed)
        return found

    def _write(self, command: canon.DriveWrite, function: DriveFunction) -> None:
        if function.communication == "CYCLIC":
            access = self._accesses[command.axis]
            raw = function.raw(command.value, command.axis)
            present = access.link.get_object(function.index, function.sub)
            whole = function.merged(raw, function.encode(present))
            access.link.set_object(function.index, function.sub, whole)
            self._open[command.axis] += 1
            self._cyclic.append(command.axis)
        elif function.communication == "ACYCLIC":
            self._write_beside(command, function)
        else:
            function.raw(command.value, command.axis)  # what it cannot be is an alarm all the same

    def _take(self, command: canon.DriveRead, function: DriveFunction, data: bytes) -> None:
        if isinstance(function, DriveIdent) and not function.can_tell(data):
            self._failed = self._failed or _unknown_ident(command, function)
        super()._take(command, function, data)


def _unknown_ident(command: canon.DriveRead, ident: DriveIdent) -> Alarm:
    return Alarm(
        900257,
        place=command.block.place,
        axis=command.axis,
        value=ident.off,
        object=object_name(ident.read_index, ident.read_sub),
        ident=ident.key,
        off=ident.off,
    )
