"""The kernel's end of one CANopen drive: a drive of CiA 402 whose values PDOs carry."""

from typing import Any

from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.canopen.process_data import ProcessData
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.sparse import SparseData
from axisrig.kernel.drives.cia402.latch_check import StandstillRoom
from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.profiles.canopen.identifiers import EMERGENCY_BASE
from axisrig.kernel.time.clock import Clock, TimeNs


class AxisLink(Cia402Drive):
    """One drive on a canopen network (simulated or real), read and written once per cycle.

    sdo, proves_latches, proves_places, room: see `Cia402Drive`. clock: by which a telegram is known
    that came before it can answer the SYNC. second_telegram: the one that carries the second
    encoder, if any does.
    """

    def __init__(
        self,
        settings: LinkSettings,
        network: Any,
        sdo: SdoClient | None = None,
        *,
        proves_latches: bool = False,
        proves_places: bool = False,
        room: StandstillRoom | None = None,
        clock: Clock | None = None,
    ) -> None:
        wanted = latch_object(settings.probe_input, settings.edge)
        found = telegrams(
            wanted,
            settings.pdo_map,
            counter=settings.has_counter,
            inputs=settings.has_inputs,
            second=settings.has_second,
            speed=settings.loop is not None,
            probe=settings.has_probe,
        )
        pdos = ProcessData(found, settings.node_id, network, clock, settings.answers_ns)
        super().__init__(
            settings,
            pdos,
            sdo,
            proves_latches=proves_latches,
            proves_places=proves_places,
            room=room,
        )
        self.network, self.latch_object, self._missing_cycles = (
            network, wanted, settings.missing_cycles,
        )  # fmt: skip
        self.telegrams: dict[str, Telegram] = found
        seconds = [t for t in found.values() if any(o.field == "second" for o in t.objects)]
        self.second_telegram: Telegram | None = seconds[0] if seconds else None
        self._pdos = pdos
        self._sparse = SparseData(found.values(), settings.node_id, network, self._note_length)
        network.subscribe(EMERGENCY_BASE + settings.node_id, self._on_emergency)

    def _note_length(self, found: tuple[str, int, int]) -> None:
        self._pdos.wrong_length = found

    def _on_emergency(self, _cob_id: int, data: bytearray, _time: float) -> None:
        self.note_emergency(data)

    def begin(self) -> None:
        """Begin the exchange: what came during the start-up does not count."""
        super().begin()
        self._sparse.begin()

    def take(self) -> None:
        """Take what this cycle's SYNC delivered; see `Cia402Drive`.

        Telegrams that come less often are counted too.
        """
        super().take()
        if self._sparse.is_watched:
            self._sparse.step(self.name, self._missing_cycles)

    def _note_second(self, second: int | None) -> None:
        has_come = second is not None or "second" in self._sparse.news
        self._sparse.news.clear()
        if second is not None:
            self._second = second
        self.second_age_cycles = 0 if has_come else self.second_age_cycles + 1

    @property
    def second_increments(self) -> int | None:
        """Position of the second encoder 0x60E4:1; None until a telegram has delivered it."""
        return self._sparse.values.get("second", self._second)

    @property
    def has_second(self) -> bool:
        """Whether a telegram carries the second encoder."""
        return self.second_telegram is not None

    def second_period_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often 0x60E4:1 is promised, None where nothing promises it."""
        telegram = self.second_telegram
        return None if telegram is None else telegram.promised_ns(cycle_ns)

    @property
    def digital_inputs(self) -> int | None:
        """The digital inputs 0x60FD; None until a telegram has delivered them."""
        return self._sparse.values.get("inputs", self._inputs)
