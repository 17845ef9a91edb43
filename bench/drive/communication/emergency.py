"""Errors of a node: the error register 1001 and the emergency messages that tell of it.

Source: CiA 301, emergency object; a message says the code and the register, code 0000 says that
an error has gone.
"""

from collections.abc import Callable
from typing import Final

from bench.drive.image import ProcessImage

NO_ERROR: Final = 0x0000
GENERIC_ERROR: Final = 1 << 0
COMMUNICATION_ERROR: Final = 1 << 4
PROFILE_ERROR: Final = 1 << 5


class Emergency:
    """The errors that stand at a node, shown in its error register.

    send(code, register) sends one message.
    """

    def __init__(self, image: ProcessImage, send: Callable[[int, int], None]) -> None:
        self._image, self._send = image, send
        self._bits: dict[int, int] = {}

    def report(self, code: int, bit: int) -> None:
        """Note an error with its bit of the register; a message only when it is new."""
        if code not in self._bits:
            self._bits[code] = bit
            self._tell(code)

    def clear(self, code: int) -> None:
        """Take an error back; a message only when it stood."""
        if self._bits.pop(code, None) is not None:
            self._tell(NO_ERROR)

    def forget(self) -> None:
        """Drop every error without a message (node reset)."""
        self._bits.clear()
        self._image.error_register = 0

    def _tell(self, code: int) -> None:
        register = GENERIC_ERROR if self._bits else 0
        for bit in self._bits.values():
            register |= bit
        self._image.error_register = register
        self._send(code, register)
