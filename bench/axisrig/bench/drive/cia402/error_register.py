"""Errors of a device: the register 1001 and what is reported of them.

Source: CiA 301, emergency object; a message says the code and the register, code 0000 says that
an error has gone.
"""

from collections.abc import Callable
from typing import Final

from axisrig.bench.drive.cia402.dictionary.image import DeviceImage

NO_ERROR: Final = 0x0000
GENERIC_ERROR: Final = 1 << 0
COMMUNICATION_ERROR: Final = 1 << 4
PROFILE_ERROR: Final = 1 << 5


class ErrorRegister:
    """The errors that are active at a node, shown in its error register.

    send(code, register, info) sends one message.
    """

    def __init__(self, image: DeviceImage, send: Callable[[int, int, int], None]) -> None:
        self._image, self._send = image, send
        self._bits: dict[tuple[int, object], int] = {}

    def report(self, code: int, bit: int, source: object = None, info: int = 0) -> None:
        """Note an error with its bit of the register; a message only when its code is new.

        source: part of the communication that has the error; it keeps two errors of one
        code separate, such as those of two PDOs. None = the application. info: first of the five
        bytes that are the device's own, 0 to 255.
        """
        if (code, source) not in self._bits:
            is_new = not self.is_active(code)
            self._bits[code, source] = bit
            if is_new:
                self._tell(code, info)

    def clear(self, code: int, source: object = None) -> None:
        """Take an error back; a message only when none of its code is left."""
        if self._bits.pop((code, source), None) is not None and not self.is_active(code):
            self._tell(NO_ERROR)

    def mention(self, code: int, bit: int) -> None:
        """Report something that is over already."""
        self._send(code, self._image.error_register | GENERIC_ERROR | bit, 0)

    def is_active(self, code: int) -> bool:
        """Whether an error with this code is active, from any source."""
        return any(known == code for known, _ in self._bits)

    def forget(self) -> None:
        """Drop every error without a message (reset of the node)."""
        self._bits.clear()
        self._show()

    def forget_communication(self) -> None:
        """Drop the errors of the communication without a message (its reset)."""
        self._bits = {key: bit for key, bit in self._bits.items() if key[1] is None}
        self._show()

    def _tell(self, code: int, info: int = 0) -> None:
        self._send(code, self._show(), info)

    def _show(self) -> int:
        register = GENERIC_ERROR if self._bits else 0
        for bit in self._bits.values():
            register |= bit
        self._image.error_register = register
        return register
