"""Service channel of a SERCOS drive over the mailbox of EtherCAT (SoE): it answers for its idents.

An answer echoes drive and elements of the question; a refusal has the code in exactly two bytes,
since masters read it from either end. Sources: `kernel/axisrig/kernel/profiles/sercos/service.py`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from axisrig.bench.drive.ethercat.mailbox import MailboxService
from axisrig.kernel.profiles.ethercat.layouts import MAILBOX, MailboxType
from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    LIST_HEADER,
    RUN,
    Attribute,
    Element,
    Header,
    Kind,
    Operation,
    command_states,
    pack_text,
    soe_errors,
)

STATES: Final = command_states()
_SINGLE: Final = {
    Element.MINIMUM: "MINIMUM",
    Element.MAXIMUM: "MAXIMUM",
    Element.DEFAULT: "DEFAULT",
}
_READ_ONLY: Final = {
    Element.DATA_STATE: "ELEMENT_1",
    Element.NAME: "NAME_READ_ONLY",
    Element.ATTRIBUTE: "ATTRIBUTE_READ_ONLY",
    Element.UNIT: "UNIT_READ_ONLY",
    Element.MINIMUM: "MINIMUM_READ_ONLY",
    Element.MAXIMUM: "MAXIMUM_READ_ONLY",
    Element.DEFAULT: "READ_ONLY",
}
"""What a write to another element than the value is refused with."""


@dataclass
class Ident:
    """One ident of a drive.

    name, unit: empty = none. minimum, maximum, default: None = none. value: as it is transmitted,
    with its lengths where it has any. capacity: bytes that a list or text may have. live(): the
    value, where that is elsewhere. check(number): name of the code that refuses a value, None.
    changed(): is called after a write. state: of a procedure command (`command_states.csv`).
    """

    attribute: Attribute
    value: bytes
    name: str = ""
    unit: str = ""
    minimum: int | None = None
    maximum: int | None = None
    default: int | None = None
    is_read_only: bool = False
    capacity: int = 0
    live: Callable[[], int] | None = None
    check: Callable[[int], str | None] = field(default=lambda _: None)
    changed: Callable[[], None] = field(default=lambda: None)
    state: int = STATES["IDLE"]

    def number(self, data: bytes) -> int:
        """Return a transmitted value as a number."""
        return int.from_bytes(data, "little", signed=self.attribute.kind is Kind.SIGNED)

    def pack(self, number: int) -> bytes:
        """Return a number as it is transmitted."""
        attribute = self.attribute
        return number.to_bytes(attribute.width, "little", signed=attribute.kind is Kind.SIGNED)


class RefusedError(Exception):
    """An access is refused; the name of its code (`soe_errors.csv`)."""


class ServiceChannel(MailboxService):
    """Answers for some drives of a slave.

    drives: idents of each by their words. size(): bytes of the mailbox to the master. phase():
    communication phase, 2 to 4. disturbances: each is asked before a request: None; "" = it gets no
    answer; name of the code that refuses it.
    """

    def __init__(
        self,
        drives: Sequence[Mapping[int, Ident]],
        size: Callable[[], int],
        phase: Callable[[], int],
    ) -> None:
        self.kind = MailboxType.SOE
        self._drives, self._size, self._phase = drives, size, phase
        self._parts = b""  # of a write that comes in fragments
        self.disturbances: list[Callable[[], str | None]] = []

    def reset(self) -> None:
        """Drop what is under way."""
        self._parts = b""

    def serve(self, body: bytes) -> list[bytes]:
        """Return the answers to a message, from the head of SoE on; none to what asks nothing."""
        try:
            head = Header.read(body)
        except ValueError:
            return []
        data = body[HEADER.size :]
        if head.operation is Operation.WRITE:
            if head.fragments:
                self._parts += data
                return []
            data, self._parts = self._parts + data, b""
            answer = Operation.WRITE_ANSWER
        elif head.operation is Operation.READ:
            answer = Operation.READ_ANSWER
        else:
            return []
        disturbed = self._disturbed()
        if disturbed == "":
            return []
        try:
            if disturbed is not None:
                raise RefusedError(disturbed)
            ident = self._find(head)
            if head.operation is Operation.WRITE:
                self._write(ident, head.elements, data)
                found = b""
            else:
                found = self._read(ident, head.elements)
        except RefusedError as refused:
            code = ERROR_CODE.pack(soe_errors()[str(refused)])
            return [Header(answer, head.drive, head.elements, head.ident, True).pack() + code]
        return self._fragments(Header(answer, head.drive, head.elements, head.ident), found)

    def _disturbed(self) -> str | None:
        return next((found for each in self.disturbances if (found := each()) is not None), None)

    def _find(self, head: Header) -> Ident:
        if head.drive >= len(self._drives):
            raise RefusedError("DRIVE")
        if not head.elements:
            raise RefusedError("NO_ELEMENT")
        found = self._drives[head.drive].get(head.ident)
        if found is None:
            raise RefusedError("NO_IDENT")
        return found

    def _fragments(self, head: Header, data: bytes) -> list[bytes]:
        room = self._size() - MAILBOX.size - HEADER.size
        cuts = [data[at : at + room] for at in range(0, len(data), room)] or [b""]
        return [
            Header(
                head.operation, head.drive, head.elements, head.ident, fragments=len(cuts) - 1 - at
            ).pack()
            + cut
            for at, cut in enumerate(cuts)
        ]

    def _read(self, ident: Ident, elements: Element) -> bytes:
        return b"".join(self._element(ident, one) for one in Element if one in elements)

    def _element(self, ident: Ident, element: Element) -> bytes:
        if element is Element.DATA_STATE:
            return ERROR_CODE.pack(ident.state)
        if element is Element.ATTRIBUTE:
            return ident.attribute.pack()
        if element is Element.VALUE:
            return ident.value if ident.live is None else ident.pack(ident.live())
        if element in (Element.NAME, Element.UNIT):
            text = ident.name if element is Element.NAME else ident.unit
            if not text:
                raise RefusedError(f"NO_{element.name}")
            return pack_text(text)
        number = {
            Element.MINIMUM: ident.minimum,
            Element.MAXIMUM: ident.maximum,
            Element.DEFAULT: ident.default,
        }[element]
        if number is None:
            raise RefusedError(f"NO_{_SINGLE[element]}")
        return ident.pack(number)

    def _write(self, ident: Ident, elements: Element, data: bytes) -> None:
        for element, code in _READ_ONLY.items():
            if element in elements:
                raise RefusedError(code)
        if ident.is_read_only:
            raise RefusedError("READ_ONLY")
        if ident.attribute.protected[self._phase() - 2]:
            raise RefusedError("PROTECTED")
        self._check_length(ident, data)
        if not ident.attribute.is_variable:
            self._check_number(ident, ident.number(data))
            refused = ident.check(ident.number(data))
            if refused is not None:
                raise RefusedError(refused)
        if ident.attribute.is_command:
            self._command(ident, ident.number(data))
        ident.value = data
        ident.changed()

    @staticmethod
    def _check_length(ident: Ident, data: bytes) -> None:
        expected = ident.attribute.width
        if ident.attribute.is_variable:
            if len(data) < LIST_HEADER.size:
                raise RefusedError("SHORT")
            length = LIST_HEADER.unpack_from(data)[0]
            if length > ident.capacity:
                raise RefusedError("LONG")
            if length % ident.attribute.width:
                raise RefusedError("INVALID")
            expected = LIST_HEADER.size + length
        if len(data) != expected:
            raise RefusedError("SHORT" if len(data) < expected else "LONG")

    @staticmethod
    def _check_number(ident: Ident, number: int) -> None:
        if ident.minimum is not None and number < ident.minimum:
            raise RefusedError("BELOW")
        if ident.maximum is not None and number > ident.maximum:
            raise RefusedError("ABOVE")

    @staticmethod
    def _command(ident: Ident, number: int) -> None:
        """Set or cancel a procedure command; who executes it says when it is done."""
        if number == 0:
            ident.state = STATES["IDLE"]
        elif number != RUN:
            raise RefusedError("INVALID")
        elif ident.state == STATES["RUNNING"]:
            raise RefusedError("ACTIVE")
        else:
            ident.state = STATES["RUNNING"]
