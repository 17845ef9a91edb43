"""TPDOs that do not answer every SYNC: those of every n-th one, and those sent on change.

Their values stay until the next ones come. Source: CiA 301 section 7.2.2.3, transmission types.
"""

from collections.abc import Callable, Iterable

from axisrig.kernel.drives.canopen.mapping import NO_FIELD, Telegram
from axisrig.kernel.drives.canopen.process_data import STAYED_OUT
from axisrig.kernel.drives.canopen.sdo import Network
from axisrig.kernel.errors import Alarm


class _Every:
    """A TPDO that answers every n-th SYNC; silent_cycles: since it came last."""

    def __init__(self, telegram: Telegram) -> None:
        self.telegram = telegram
        self.has_come = False
        self.silent_cycles = 0


class SparseData:
    """Keeps what such TPDOs deliver; values: by field. news: fields that came since the last take.

    wrong_length: takes name, length and expected length of a PDO that does not fit its mapping.
    is_watched: whether any of them has to come again and again.
    """

    def __init__(
        self,
        telegrams: Iterable[Telegram],
        node_id: int,
        network: Network,
        wrong_length: Callable[[tuple[str, int, int]], None],
    ) -> None:
        self.values: dict[str, int] = {}
        self.news: set[str] = set()
        self._wrong_length = wrong_length
        self._every: list[_Every] = []
        for telegram in telegrams:
            has_field = any(mapped.field for mapped in telegram.objects)
            if telegram.is_received or telegram.transmission == 1:
                continue
            if telegram.is_cyclic or has_field:
                network.subscribe(telegram.cob_id(node_id), self._taker(telegram))
        self.is_watched = bool(self._every)

    def _taker(self, telegram: Telegram) -> Callable[[int, bytearray, float], None]:
        fields = [
            (position, mapped.field)
            for position, mapped in enumerate(telegram.objects)
            if mapped.field != NO_FIELD
        ]
        every = _Every(telegram) if telegram.is_cyclic else None
        if every is not None:
            self._every.append(every)

        def take(_cob_id: int, data: bytearray, _time: float) -> None:
            if len(data) != telegram.codec.size:
                self._wrong_length((telegram.name, len(data), telegram.codec.size))
                return
            if every is not None:
                every.has_come = True
            if fields:
                values = telegram.codec.unpack(data)
                for position, field in fields:
                    self.values[field] = values[position]
                    self.news.add(field)

        return take

    def begin(self) -> None:
        """Count from now on."""
        for every in self._every:
            every.silent_cycles = 0

    def step(self, axis: str, missing_max: int) -> None:
        """Count a cycle; raises Alarm 900006 for one that stayed out too often in a row."""
        for every in self._every:
            every.silent_cycles = 0 if every.has_come else every.silent_cycles + 1
            every.has_come = False
            missing = every.silent_cycles // every.telegram.transmission
            if missing > missing_max:
                raise Alarm(STAYED_OUT, axis=axis, pdo=every.telegram.name, cycles=missing)
