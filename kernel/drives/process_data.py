"""The PDOs of one drive while the cycle runs: what came with the last SYNC, what goes out next.

Every cyclic TPDO belongs to the SYNC that it answers; one that stays out is counted. Values are
found by the fields of the mapping table (`mapping.FIELDS`), so a table may order them as it likes.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final

from kernel.drives.ds402 import find_state
from kernel.drives.mapping import MappedObject, Telegram
from kernel.drives.sdo import Network

# Where the value of a field that is not mapped is looked up: behind the telegrams there is a zero
ABSENT: Final = (-1, 0)
_ZERO: Final = (0,)
# Why a telegram could not be used: alarm IDs
STAYED_OUT, CONTRADICTED, NO_STATE = 900006, 900080, 900081

Values = tuple[int, ...]
Place = tuple[int, int]


class ProcessData:
    """Takes the TPDOs of a drive apart and packs its RPDOs.

    missing: for each cyclic TPDO how many cycles in a row it has stayed out or could not be used.
    causes: the alarm ID of the last such cycle. wrong_length: name and lengths of a PDO that did
    not fit its mapping, None = all did.
    """

    def __init__(self, telegrams: Mapping[str, Telegram], node_id: int, network: Network) -> None:
        self._network = network
        everything = telegrams.values()
        self._cyclic = [t for t in everything if t.is_cyclic and not t.is_received]
        self.names = [t.name for t in self._cyclic]
        self._unpack: list[Callable[[bytes], Values]] = [t.codec.unpack for t in self._cyclic]
        self._data: list[bytes | None] = [None] * len(self._cyclic)
        self._empty = list(self._data)
        self._contradicted: set[int] = set()
        self.missing = [0] * len(self._cyclic)
        self.causes = [STAYED_OUT] * len(self._cyclic)
        self._status = self.place("statusword")
        self.wrong_length: tuple[str, int, int] | None = None
        for slot, telegram in enumerate(self._cyclic):
            network.subscribe(telegram.cob_id(node_id), self._receiver(slot, telegram))
        self._sent = [t for t in everything if t.is_received]
        self._out = [[0] * len(t.objects) for t in self._sent]
        self._pack = [
            (t.cob_id(node_id), t.codec.pack, values)
            for t, values in zip(self._sent, self._out, strict=True)
        ]

    def _receiver(self, slot: int, telegram: Telegram) -> Callable[[int, bytearray, float], None]:
        size, name = telegram.codec.size, telegram.name

        def receive(_can_id: int, data: bytearray, _timestamp: float) -> None:
            if len(data) == size:
                known = self._data[slot]
                if known is not None and known != data:
                    # One of both is late or of another node: which one?
                    self._contradicted.add(slot)
                self._data[slot] = bytes(data)
            else:
                self.wrong_length = (name, len(data), size)

        return receive

    # Received

    def place(self, field: str) -> Place:
        """Return where `take` puts a field: number of the cyclic TPDO, position in it."""
        for slot, telegram in enumerate(self._cyclic):
            for position, mapped in enumerate(telegram.objects):
                if mapped.field == field:
                    return slot, position
        return ABSENT

    def begin_cycle(self) -> None:
        """Forget what is there: a SYNC counts with its own answers only."""
        self._data[:] = self._empty
        if self._contradicted:
            self._contradicted.clear()

    def take(self) -> list[Values | None]:
        """Take what the last SYNC brought, one entry per cyclic TPDO (None: it stayed out).

        A telegram that came twice with different contents, or whose status word cannot be, counts
        as one that stayed out.
        """
        status_slot, status_position = self._status
        values: list[Values | None] = []
        for slot, data in enumerate(self._data):
            found = None if data is None else self._unpack[slot](data)
            cause = STAYED_OUT
            if slot in self._contradicted:
                found, cause = None, CONTRADICTED
            elif found and slot == status_slot and find_state(found[status_position]) is None:
                found, cause = None, NO_STATE
            if found is None:
                self.missing[slot] += 1
                self.causes[slot] = cause
            else:
                self.missing[slot] = 0
            values.append(found)
        self.begin_cycle()
        values.append(_ZERO)
        return values

    # Sent

    def sent_place(self, field: str) -> tuple[list[int], int] | None:
        """Return the values of the RPDO that carries a field, and its position in them."""
        return self._find(lambda mapped: mapped.field == field)

    def sent_object(self, index: int, sub: int) -> tuple[list[int], int] | None:
        """Return the values of the RPDO that carries an object, and its position in them."""
        return self._find(lambda mapped: (mapped.index, mapped.sub) == (index, sub))

    def _find(self, wanted: Callable[[MappedObject], Any]) -> tuple[list[int], int] | None:
        for telegram, values in zip(self._sent, self._out, strict=True):
            for position, mapped in enumerate(telegram.objects):
                if wanted(mapped):
                    return values, position
        return None

    def send(self) -> None:
        """Send every RPDO with its present values."""
        for cob_id, pack, values in self._pack:
            self._network.send_message(cob_id, pack(*values))
