"""What the channel watches in every cycle: buses, connections, drives; and switching them on."""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.channel.path.settings import CycleTiming
from axisrig.kernel.drives.carrier import Carrier, Presence
from axisrig.kernel.drives.interface import Drive, DriveWatch
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.errors import Alarm

POWER_UP_CYCLES_MAX: Final = 500
FAULT_CYCLES_MAX: Final = 50  # long enough for a reset and for a drive that looks once more


class Monitor:
    """Takes what the buses delivered and returns the most specific alarm of a cycle.

    watches: over the drives, in the order of the links. presences: what the kernel shows of itself.
    """

    def __init__(
        self,
        links: Sequence[Drive],
        carriers: Sequence[Carrier],
        watches: Sequence[DriveWatch],
        presences: Sequence[Presence] = (),
    ) -> None:
        self._links, self._presences = links, presences
        self._drives, self._carriers = list(watches), list(carriers)
        self._late: Alarm | None = None
        self.further: list[Alarm] = []

    def prepare(self) -> None:
        """Let the drives hear the kernel, before they are set to watch it."""
        for presence in self._presences:
            presence.begin()

    def begin(self) -> None:
        """Watch from now on: the drives are started."""
        for drive in self._drives:
            drive.begin()

    def end(self) -> None:
        """Watch no more."""
        for drive in self._drives:
            drive.end()
        for presence in self._presences:
            presence.end()

    def begin_cycle(self) -> None:
        """Look whether the cycle that ends has begun on every segment, then begin the next one."""
        for carrier in self._carriers:
            if carrier.holds_back:
                self._late = self._late or carrier.late()
        for link in self._links:
            link.begin_cycle()
        for carrier in self._carriers:
            carrier.begin_cycle()

    def take(self) -> None:
        """Take the telegrams of every link.

        Raises the most specific alarm: own controller, SYNC, connection of a drive, telegrams;
        the others of this cycle are in `further`.
        """
        silent: list[Alarm] = []
        for link in self._links:
            try:
                link.take()
            except Alarm as alarm:
                silent.append(alarm)
        found: list[Alarm] = []
        for carrier in self._carriers:
            if (wrong := carrier.check()) is not None:
                found.append(wrong)
        if self._late is not None:
            found.append(self._late)
            self._late = None  # the next cycle has a SYNC of its own
        for drive in self._drives:
            if (wrong := drive.communication()) is not None:
                found.append(wrong)
        if found or silent:
            self._raise(found + silent)

    def check_drives(self) -> None:
        """Raise the alarm of the first drive that does not follow its set values any more.

        Those of other drives are in `further`.
        """
        found: list[Alarm] = []
        for drive in self._drives:
            if (wrong := drive.condition()) is not None:
                found.append(wrong)
        if found:
            self._raise(found)

    def _raise(self, found: list[Alarm]) -> None:
        self.further = found[1:]
        raise found[0]


class PowerUp:
    """Leads all drives to operation enabled; resets_faults: acknowledges those that are active."""

    def __init__(
        self, links: Sequence[Drive], timing: CycleTiming, *, resets_faults: bool = False
    ) -> None:
        self._links, self._timing, self._resets_faults = links, timing, resets_faults
        self._cycles = 0
        self._asked: set[str] = set()

    def step(self) -> bool:
        """Do one cycle; return whether every drive is there.

        Raises Alarm 900005 for one that stays in fault, 900008 when one takes too long, 900084 and
        900085 for one whose place is not proved.
        """
        self._cycles += 1
        for link in self._links:
            link.find_place()
        waiting = [
            link for link in self._links if link.power is not Power.OPERATING or not link.is_placed
        ]
        for link in self._links:
            link.order(PowerOrder.SWITCH_ON)
            link.acknowledges_faults = self._resets_faults or link.settings.fault_reset
            if link.is_in_fault:
                self._judge_fault(link)
        if waiting and self._cycles > POWER_UP_CYCLES_MAX:
            raise Alarm(
                900008,
                axis=waiting[0].name,
                state=waiting[0].state_name,
                ms=self._cycles * self._timing.period_ns // 1_000_000,
            )
        if not waiting:
            for link in self._links:
                link.forget_fault()
        return not waiting

    def _judge_fault(self, link: Drive) -> None:
        """Ask for a fault that nobody has heard of, and raise Alarm 900005 when it stays."""
        if link.name not in self._asked and not link.has_reported:
            self._asked.add(link.name)
            link.ask_for_fault()
        if self._cycles > (POWER_UP_CYCLES_MAX if link.is_asked else FAULT_CYCLES_MAX):
            raise link.fault()
