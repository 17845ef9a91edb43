"""The PDOs of one drive while the cycle runs: what came with the last SYNC, what is sent next.

Every TPDO of type 1 belongs to the SYNC that it answers; one that stays out is counted. Those that
come less often are in `sparse.py`. Values are
found by the fields of the mapping table (`mapping.FIELDS`), so a table may order them as it likes.
"""

import struct
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any

from axisrig.kernel.drives.canopen.mapping import FROM_LATCH_TO_STAMP, Telegram
from axisrig.kernel.drives.canopen.sdo import Network
from axisrig.kernel.drives.cia402.cyclic_data import TAKEN, CyclicData, Values
from axisrig.kernel.drives.cia402.words import find_state
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.time.clock import Clock, TimeNs

# Why a telegram could not be used: alarm IDs
STAYED_OUT, CONTRADICTED, NO_STATE = 900006, 900080, 900081

Place = tuple[int, int]


class ProcessData(CyclicData):
    """Takes the TPDOs of a drive apart and packs its RPDOs; names: of its cyclic TPDOs.

    answers_ns: how long after a SYNC a telegram with 0, 1 .. bytes can end at the earliest, by the
    clock; one that ends before is of an earlier SYNC, or of nobody who has heard this one.
    """

    def __init__(
        self,
        telegrams: Mapping[str, Telegram],
        node_id: int,
        network: Network,
        clock: Clock | None = None,
        answers_ns: Sequence[TimeNs] = (),
    ) -> None:
        self._clock, self._answers_ns = clock, tuple(answers_ns)
        self._sync_ns: TimeNs = 0
        everything = telegrams.values()
        self._cyclic = [t for t in everything if t.transmission == 1 and not t.is_received]
        super().__init__([t.name for t in self._cyclic], STAYED_OUT)
        self._network = network
        self._count = len(self._cyclic)
        self._places = [self._place(_of_field(field)) for field in TAKEN]
        latch = self._places[TAKEN.index("latch")]
        if latch is not None:
            self._find_stamp(self._cyclic[latch[0]].objects[latch[1]].index)
        self._pick = self._picker()
        self._unpack_all = _joined([t.codec for t in self._cyclic])
        self._data: list[bytes | None] = [None] * self._count
        self._empty = list(self._data)
        self._contradicted: set[int] = set()
        self._good_word: int | None = None
        for slot, telegram in enumerate(self._cyclic):
            network.subscribe(telegram.cob_id(node_id), self._receiver(slot, telegram))
        self._sent = [t for t in everything if t.is_received]
        self._out = [[0] * len(t.objects) for t in self._sent]
        self._pack = [
            (t.cob_id(node_id), t.codec.pack, values)
            for t, values in zip(self._sent, self._out, strict=True)
        ]

    def _receiver(self, slot: int, telegram: Telegram) -> Callable[[int, bytearray, float], None]:
        size, name, clock = telegram.codec.size, telegram.name, self._clock
        first_ns = self._answers_ns[size] if self._answers_ns else 0

        def receive(_can_id: int, data: bytearray, _timestamp: float) -> None:
            if clock is not None and clock.now_ns < self._sync_ns + first_ns:
                return
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

    def choose_latch(self, latch_object: int, counter_object: int) -> bool:
        """Take the latched position and its counter from these objects from now on.

        Returns False, and changes nothing, when no TPDO delivers the position with every SYNC.
        """
        latch = self._place(lambda mapped: mapped.index == latch_object)
        if latch is None:
            return False
        self._places[TAKEN.index("latch")] = latch
        count = self._place(lambda mapped: mapped.index == counter_object)
        self._places[TAKEN.index("latch_count")] = count
        self._find_stamp(latch_object)
        self._pick = self._picker()
        return True

    def _find_stamp(self, latch_object: int) -> None:
        """Take the time stamp (60D1 to 60D4) that belongs to a latch object, where it is mapped."""
        wanted = latch_object + FROM_LATCH_TO_STAMP
        place = self._place(lambda mapped: mapped.index == wanted)
        self._places[TAKEN.index("stamp")] = place

    def _place(self, wanted: Callable[[MappedObject], bool]) -> Place | None:
        """Return where an object is: number of its cyclic TPDO, position in it."""
        for slot, telegram in enumerate(self._cyclic):
            for position, mapped in enumerate(telegram.objects):
                if wanted(mapped):
                    return slot, position
        return None

    def _picker(self) -> Callable[[Sequence[int | None]], Sequence[int | None]]:
        """Make the function that picks the fields from the values of all TPDOs in a row."""
        latch, count = (self._places[TAKEN.index(field)] for field in ("latch", "latch_count"))
        if latch is not None and count is not None and latch[0] != count[0]:
            # A counter proves a latch only when one telegram carries both
            self._places[TAKEN.index("latch_count")] = None
        begins = [sum(len(t.objects) for t in self._cyclic[:slot]) for slot in range(self._count)]
        # After all values comes a None, for fields that are not mapped
        return itemgetter(*(begins[p[0]] + p[1] if p else -1 for p in self._places))

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        self.begin_cycle()
        self.wrong_length, self.is_disturbed = None, False
        self.missing[:] = [0] * len(self.missing)

    def begin_cycle(self) -> None:
        """Forget what is there: a SYNC counts with its own answers only."""
        if self._clock is not None:
            self._sync_ns = self._clock.now_ns
        self._data[:] = self._empty
        if self._contradicted:
            self._contradicted.clear()

    def take(self) -> Sequence[int | None]:
        """Take what the last SYNC delivered: the values of `TAKEN`, None for what is not there.

        A telegram that came twice with different contents, or whose status word cannot be, counts
        as one that stayed out.
        """
        data = self._data
        if self._unpack_all is None or self._contradicted or None in data:
            return self._take_each()
        values = self._unpack_all(b"".join(data))  # type: ignore[arg-type]
        picked = self._pick((*values, None))
        word = picked[0]
        if word != self._good_word:
            if find_state(word) is None:
                return self._take_each()
            self._good_word = word
        if self.is_disturbed:
            self.missing[:] = [0] * self._count
            self.is_disturbed = False
        data[:] = self._empty
        return picked

    def _take_each(self) -> Sequence[int | None]:
        """Take telegram by telegram, and count those that cannot be used."""
        slot_of_status, position = self._places[0] or (0, 0)
        values: list[int | None] = []
        self.is_disturbed = False
        for slot, data in enumerate(self._data):
            found = None if data is None else self._cyclic[slot].codec.unpack(data)
            cause = STAYED_OUT
            if slot in self._contradicted:
                found, cause = None, CONTRADICTED
            elif found and slot == slot_of_status and find_state(found[position]) is None:
                found, cause = None, NO_STATE
            if found is None:
                self.missing[slot] += 1
                self.causes[slot] = cause
                self.is_disturbed = True
            else:
                self.missing[slot] = 0
            values += found or [None] * len(self._cyclic[slot].objects)
        self.begin_cycle()
        return self._pick((*values, None))

    # Sent

    def sent_place(self, field: str) -> Values | None:
        """Return the values of the RPDO that carries a field, and its position in them."""
        return self._find(lambda mapped: mapped.field == field)

    def sent_object(self, index: int, sub: int) -> Values | None:
        """Return the values of the RPDO that carries an object, and its position in them."""
        return self._find(lambda mapped: (mapped.index, mapped.sub) == (index, sub))

    def _find(self, wanted: Callable[[MappedObject], Any]) -> Values | None:
        for telegram, values in zip(self._sent, self._out, strict=True):
            for position, mapped in enumerate(telegram.objects):
                if wanted(mapped):
                    return values, position
        return None

    def send(self) -> None:
        """Send every RPDO with its present values."""
        for cob_id, pack, values in self._pack:
            self._network.send_message(cob_id, pack(*values))


def _of_field(field: str) -> Callable[[MappedObject], bool]:
    return lambda mapped: mapped.field == field


def _joined(codecs: Sequence[Any]) -> Callable[[bytes], tuple[int, ...]] | None:
    """Return one codec for all telegrams in a row; None when a length has no `struct`."""
    if not all(isinstance(codec, struct.Struct) for codec in codecs):
        return None
    return struct.Struct("<" + "".join(codec.format[1:] for codec in codecs)).unpack
