"""Objects of a drive as a control asks for them beside the cycle, whatever carries the question.

Source: CiA 301 section 7.2.4, which CAN and the mailbox of EtherCAT (CoE) share.
"""

from collections.abc import Callable

from axisrig.kernel.drives.functions import AccessError
from axisrig.kernel.profiles.canopen.aborts import abort_text


class SdoError(AccessError):
    """An object could not be read or written.

    code: the abort code, None when the server was silent. by_server: who gave up.
    """

    def __init__(self, index: int, sub: int, code: int | None, by_server: bool = True) -> None:
        self.index, self.sub, self.code, self.by_server = index, sub, code, by_server
        self.target = object_name(index, sub)
        super().__init__(abort_text(code) if code is not None else "no answer")


def object_name(index: int, sub: int) -> str:
    """Write an object as rigs and messages do: 0x6072:0."""
    return f"0x{index:04X}:{sub:X}"


Done = Callable[[bytes | SdoError], None]
"""Takes the data of an object (empty after a write) or the reason why there are none."""


class ObjectAccess:
    """Reads and writes objects of one drive; never waits, requests run in turn."""

    def read(self, index: int, sub: int, done: Done) -> None:
        """Read an object; `done` gets its bytes."""
        raise NotImplementedError

    def write(self, index: int, sub: int, data: bytes, done: Done) -> None:
        """Write an object; `done` gets b"" when the server has taken it."""
        raise NotImplementedError
