"""#IDENT and #COMMAND of a running program: idents of SERCOS drives over the service channel.

Source: TF5200 programming manual 207347083, 207377291. A write waits until the drive has taken the
value, unless the program says otherwise; an error of it comes up when the answer is there. A
procedure command has ended when its data state is no longer 7; then it is cancelled.
"""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.drives.accesses import AnsweredAccesses
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.profiles.sercos.service import (
    Attribute,
    Element,
    Kind,
    command_states,
    ident_number,
    parts_of,
)

_STATES: Final = command_states()
IDLE, RUNNING, DONE = _STATES["IDLE"], _STATES["RUNNING"], _STATES["DONE"]
BOTH = Element.ATTRIBUTE | Element.VALUE


class SercosAccesses(AnsweredAccesses):
    """Carries out the #IDENT commands of a channel; drives: by axis."""

    def __init__(self, drives: Mapping[str, SercosDrive]) -> None:
        super().__init__()
        self._drives = drives
        self._started: dict[str, list[str]] = {name: [] for name in drives}
        self._waits = 0  # a reset ends those before

    def reset(self) -> None:
        """Let nothing wait any more; a procedure command that runs goes on, and nobody asks."""
        super().reset()
        self._waits += 1

    def begin(self, command: canon.DriveCommand) -> None:
        """Begin one command; raises Alarm 900110 to 900112, 900255 and 900256."""
        super().begin(command)
        if isinstance(command, canon.DriveWait) and command.commands:
            # A copy: each one is taken out of the list when it is asked for
            for name in [command.key] if command.key else list(self._started[command.axis]):
                self._open[command.axis] += 1
                self._await_end(command, name, self._waits)

    def _await_end(self, command: canon.DriveWait, name: str, waits: int) -> None:
        """Ask for the data state of a procedure command until it has ended, then cancel it."""
        drive, ident = self._drives[command.axis], ident_number(name)

        def answered(found: bytes | SoeError) -> None:
            state = IDLE if isinstance(found, SoeError) else int.from_bytes(found, "little")
            if isinstance(found, SoeError):
                self._close(command, found, name)
            elif waits != self._waits:
                self._close(command, None, name)
            elif state == RUNNING:
                self._await_end(command, name, waits)
            else:
                wrong = None if state in (IDLE, DONE) else self._not_done(command, name, state)
                drive.channel.write(
                    drive.drive_number,
                    ident,
                    bytes(2),
                    lambda found: self._close(
                        command, wrong or (found if isinstance(found, SoeError) else None), name
                    ),
                )

        if name in self._started[command.axis]:
            self._started[command.axis].remove(name)
        drive.channel.read(drive.drive_number, ident, Element.DATA_STATE, answered)

    @staticmethod
    def _not_one(command: canon.DriveWrite) -> Alarm:
        return Alarm(900749, place=command.block.place, axis=command.axis, key=command.key)

    @staticmethod
    def _not_done(command: canon.DriveWait, name: str, state: int) -> Alarm:
        return Alarm(
            900748, place=command.block.place, axis=command.axis, key=name, state=f"0x{state:X}"
        )

    def _carry_out(self, command: canon.DriveRead | canon.DriveWrite) -> None:
        if command.length_bytes is None:
            raise Alarm(900110, axis=command.axis, key=command.key, known="none")
        try:
            ident = ident_number(command.key.upper())
        except ValueError as error:
            raise Alarm(
                900255, axis=command.axis, ident=command.key, known="idents of its own"
            ) from error
        self._open[command.axis] += 1
        if isinstance(command, canon.DriveRead):
            self._read(command, ident)
        else:
            self._write(command, ident)

    def _read(self, command: canon.DriveRead, ident: int) -> None:
        drive = self._drives[command.axis]

        def done(found: bytes | SoeError) -> None:
            if isinstance(found, SoeError):
                self._close(command, found)
                return
            attribute = Attribute.read(found[:4])
            wrong = self._length(command, attribute)
            if wrong is None:
                value = parts_of(BOTH, found, attribute)[Element.VALUE]
                number = int.from_bytes(value, "little", signed=attribute.kind is Kind.SIGNED)
                self._values[command.axis, command.key.upper()] = float(number)
            self._close(command, wrong)

        drive.channel.read(drive.drive_number, ident, BOTH, done)

    def _write(self, command: canon.DriveWrite, ident: int) -> None:
        drive = self._drives[command.axis]

        def known(found: bytes | SoeError) -> None:
            if isinstance(found, SoeError):
                self._close(command, found)
                return
            attribute = Attribute.read(found)
            wrong = self._length(command, attribute)
            if command.is_command and not attribute.is_command:
                wrong = self._not_one(command)
            elif command.is_command:
                self._started[command.axis].append(command.key)
            number = round(command.value)
            is_signed = attribute.kind is Kind.SIGNED
            try:
                data = number.to_bytes(attribute.width, "little", signed=is_signed)
            except OverflowError:
                text = f"{8 * attribute.width} bits, {'signed' if is_signed else 'unsigned'}"
                wrong = wrong or Alarm(
                    900112,
                    place=command.block.place,
                    axis=command.axis,
                    key=command.key,
                    value=str(number),
                    data_type=text,
                )
            if wrong is not None:
                self._close(command, wrong)
            else:
                drive.channel.write(drive.drive_number, ident, data, taken)

        def taken(found: bytes | SoeError) -> None:
            self._close(command, found if isinstance(found, SoeError) else None)

        drive.channel.read(drive.drive_number, ident, Element.ATTRIBUTE, known)

    @staticmethod
    def _length(command: canon.DriveWrite | canon.DriveRead, attribute: Attribute) -> Alarm | None:
        """Return Alarm 900256 where TYP is not the length of the ident, or it is a list or text."""
        if command.length_bytes == attribute.width and not attribute.is_variable:
            return None
        allowed = f"{attribute.width} for {command.key}"
        if attribute.is_variable:
            allowed = f"none for {command.key}: it is a {'list' if attribute.is_list else 'text'}"
        return Alarm(
            900256,
            place=command.block.place,
            keyword="TYP",
            value=f"{command.length_bytes}",
            allowed=allowed,
        )

    def _close(
        self,
        command: canon.DriveWrite | canon.DriveRead | canon.DriveWait,
        wrong: SoeError | Alarm | None,
        key: str | None = None,
    ) -> None:
        """Note that a command is over; a failure comes up in the next cycle. key: its ident."""
        self._open[command.axis] -= 1
        if wrong is None or self._failed is not None:
            return
        if isinstance(wrong, SoeError):
            wrong = Alarm(
                900032,
                place=command.block.place,
                axis=command.axis,
                key=key or command.key,
                object="service channel",
                answer=str(wrong),
            )
        self._failed = wrong
