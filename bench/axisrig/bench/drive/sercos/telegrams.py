"""AT and MDT of a drive: what S-0-0016 and S-0-0024 list, behind status and control word.

Source: AX5000 ident descriptions 969164683: the words come first and are in no list.
"""

import struct
from collections.abc import Callable
from typing import Final

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.mapping import Layout
from axisrig.bench.drive.ethercat.process_data import Exchanged
from axisrig.bench.drive.sercos.idents import Idents
from axisrig.kernel.profiles.sercos.words import (
    AT_LIST,
    LISTED,
    MDT_LIST,
    REAL_TIME,
    TELEGRAM_TYPE,
    TelegramIdent,
    telegram_idents,
)

_FORMAT: Final = {(2, False): "H", (2, True): "h", (4, False): "I", (4, True): "i"}
_WORD: Final = "H"
_ALL: Final = 0xFFFF
_STUCK: Final = {
    f"{word}_{number}": (word, mask)
    for word in ("CONTROL", "STATUS")
    for number, mask in enumerate(REAL_TIME, 1)
}


class Telegrams(Exchanged):
    """Both telegrams. image_name(ident): of its value. take_control(word): S-0-0134 of a cycle.

    status(): S-0-0135 now.
    """

    def __init__(
        self,
        idents: Idents,
        image_name: Callable[[int], str],
        take_control: Callable[[int], None],
        status: Callable[[], int],
    ) -> None:
        super().__init__()
        self._idents, self._image_name = idents, image_name
        self._take_control, self._status = take_control, status
        self._sent: list[int] = []
        self._received: list[str] = []
        # Of the words on the wire: bits that are 1, and bits that may be
        self.control_held, self.control_passes = 0, _ALL
        self.status_held, self.status_passes = 0, _ALL

    def wrong(self) -> list[int]:
        """Return what the telegrams cannot carry, or the drive cannot do: for S-0-0021."""
        is_listed = self._idents.number(TELEGRAM_TYPE) == LISTED
        found = [] if is_listed else [TELEGRAM_TYPE]
        return found + self._wrong_in("at", AT_LIST) + self._wrong_in("mdt", MDT_LIST)

    @property
    def has_wrong_inputs(self) -> bool:
        """Whether what is wrong is in the AT; otherwise it is the type, or in the MDT."""
        is_listed = self._idents.number(TELEGRAM_TYPE) == LISTED
        return is_listed and bool(self._wrong_in("at", AT_LIST))

    def _wrong_in(self, telegram: str, listed: int) -> list[int]:
        """Return the wrong idents of a list, and the list itself where one is there twice."""
        known, items = telegram_idents(), self._idents.items(listed)
        found = []
        for item in items:
            row = known.get(item)
            if row is None or row.telegram != telegram or item not in self._idents.table:
                found.append(item)
        if len(set(items)) != len(items):
            found.append(listed)
        return found

    def compile(self) -> frozenset[str]:
        """Read both lists, which are right (`wrong`)."""
        known, idents = telegram_idents(), self._idents
        self._sent, taken = idents.items(AT_LIST), idents.items(MDT_LIST)
        self._received = [self._image_name(ident) for ident in taken]
        self.inputs = _layout(("statusword",), [known[ident] for ident in self._sent])
        self.outputs = _layout(("controlword",), [known[ident] for ident in taken])
        return frozenset(self._image_name(ident) for ident in self._sent)

    def take(self, image: ProcessImage, data: bytes) -> None:
        """Take the MDT of a cycle: its values, then the control word."""
        control, *values = self.outputs.codec.unpack_from(data)
        for name, value in zip(self._received, values, strict=True):
            setattr(image, name, value)
        self._take_control(control & self.control_passes | self.control_held)

    def hold(self, name: str, *, level: bool | None) -> None:
        """Let a real-time bit keep its level on the wire; None: it passes again.

        name: CONTROL_1 to STATUS_2.
        """
        word, mask = _STUCK[name]
        held, free = mask if level else 0, mask if level is None else 0
        if word == "CONTROL":
            self.control_held = self.control_held & ~mask | held
            self.control_passes = self.control_passes & ~mask | free
        else:
            self.status_held = self.status_held & ~mask | held
            self.status_passes = self.status_passes & ~mask | free

    def message(self, image: ProcessImage) -> bytes:
        """Return the AT as it is now."""
        number = self._idents.number
        status = self._status() & self.status_passes | self.status_held
        return self.inputs.codec.pack(status, *[number(ident) for ident in self._sent])


def _layout(fields: tuple[str, ...], carried: list[TelegramIdent]) -> Layout:
    formats = "".join(_FORMAT[row.bytes, row.is_signed] for row in carried)
    return Layout(fields, struct.Struct(f"<{_WORD}{formats}"))
