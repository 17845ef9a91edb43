"""What the channel watches in every cycle: buses, connections, drives; and switching them on."""

from collections.abc import Sequence
from typing import Any

from axisrig.kernel.channel.path.settings import CycleTiming
from axisrig.kernel.drives.canopen.active_fault import ActiveFault
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.watch import (
    BusWatch,
    DriveWatch,
    HeartbeatProducer,
    WatchSettings,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import Clock

POWER_UP_CYCLES_MAX = 500
FAULT_CYCLES_MAX = 50  # long enough for a reset and for a drive that looks once more


class Monitor:
    """Takes what the buses delivered and returns the most specific alarm of a cycle.

    watches: per drive, in the order of the links; without them each gets one of the defaults.
    heartbeat: the kernel's own.
    """

    def __init__(
        self,
        links: Sequence[AxisLink],
        networks: Sequence[Any],
        clock: Clock,
        watches: Sequence[WatchSettings] = (),
        heartbeat: HeartbeatProducer | None = None,
    ) -> None:
        self._links, self._heartbeat = links, heartbeat
        settings = watches or [WatchSettings()] * len(links)
        self._drives = [DriveWatch(link, clock, s) for link, s in zip(links, settings, strict=True)]
        self._buses = [BusWatch(network) for network in networks]
        self._late_sync: Alarm | None = None
        self.further: list[Alarm] = []

    def prepare(self) -> None:
        """Let the drives hear the kernel, before they are set to watch it."""
        if self._heartbeat is not None:
            self._heartbeat.begin()

    def begin(self) -> None:
        """Watch from now on: the drives are started."""
        for drive in self._drives:
            drive.begin()

    def end(self) -> None:
        """Watch no more."""
        for drive in self._drives:
            drive.end()
        if self._heartbeat is not None:
            self._heartbeat.end()

    def before_sync(self) -> None:
        """Look whether the SYNC of the cycle that ends has got onto the bus."""
        for bus in self._buses:
            if bus.holds_back_sync:
                self._late_sync = self._late_sync or Alarm(900031, segment=bus.name)

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
        for bus in self._buses:
            if (wrong := bus.check()) is not None:
                found.append(wrong)
        if self._late_sync is not None:
            found.append(self._late_sync)
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
        self, links: Sequence[AxisLink], timing: CycleTiming, *, resets_faults: bool = False
    ) -> None:
        self._links, self._timing, self._resets_faults = links, timing, resets_faults
        self._cycles = 0
        self._faults: dict[str, ActiveFault] = {}

    def step(self) -> bool:
        """Do one cycle; return whether every drive is there.

        Raises Alarm 900005 for one that stays in fault, 900008 when one takes too long.
        """
        self._cycles += 1
        waiting = [link for link in self._links if link.state is not State.OPERATION_ENABLED]
        for link in self._links:
            link.power = True
            link.resets_fault = self._resets_faults or link.settings.fault_reset
            if link.state is State.FAULT:
                self._judge_fault(link)
        if waiting and self._cycles > POWER_UP_CYCLES_MAX:
            raise Alarm(
                900008,
                axis=waiting[0].name,
                state=waiting[0].state.name,
                ms=self._cycles * self._timing.period_ns // 1_000_000,
            )
        if not waiting:
            for link in self._links:
                link.emergency = None  # what led here is over
                link.resets_fault = False
        return not waiting

    def _judge_fault(self, link: AxisLink) -> None:
        """Ask for a fault that nobody has heard of, and raise Alarm 900005 when it stays."""
        fault = self._faults.get(link.name)
        if fault is None:
            fault = self._faults[link.name] = ActiveFault(link.sdo)
        if link.emergency is None:
            fault.ask()
        waits_max = POWER_UP_CYCLES_MAX if fault.is_open else FAULT_CYCLES_MAX
        if self._cycles > waits_max:
            emergency = fault if link.emergency is None else link.emergency
            word = f"0x{link.statusword:04X}"
            raise Alarm(900005, axis=link.name, statusword=word, emcy=str(emergency))
