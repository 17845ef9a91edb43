"""Watches over a drive while a program runs; each finding is an alarm.

`LinkWatch` listens to what a drive says beside its cyclic telegrams: boot-up, heartbeat or node
guarding, emergencies. Sources: CiA 301 sections 7.2.7 (EMCY), 7.2.8 (error control, boot-up).
"""

from dataclasses import dataclass
from functools import partial
from typing import Final

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.cia402.watch import Cia402Watch
from axisrig.kernel.drives.position_watch import jump_alarm
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE
from axisrig.kernel.profiles.canopen.nmt import BOOT_UP, OPERATIONAL, PRE_OPERATIONAL, STOPPED
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

NMT_STATES = {STOPPED: "stopped", OPERATIONAL: "operational", PRE_OPERATIONAL: "pre-operational"}
ONE_BYTE = b"\0"  # length of the answer of node guarding: state and toggle bit
TOGGLE: Final = 0x80


@dataclass(frozen=True)
class WatchSettings:
    """How a drive is watched. heartbeat_ns: longest distance of its heartbeats, 0 = not watched.

    guard_ns, life_factor: node guarding, a question every guard_ns, 0 = none.
    """

    heartbeat_ns: TimeNs = 0
    guard_ns: TimeNs = 0
    life_factor: int = 3


class LinkWatch(Cia402Watch):
    """The watch over one drive; begins with `begin`, asked once per cycle."""

    def __init__(self, link: AxisLink, clock: Clock, settings: WatchSettings) -> None:
        super().__init__(link)
        self._link, self._clock, self._settings = link, clock, settings
        self._id = ERROR_CONTROL_BASE + link.node_id
        self._is_watching = False
        self._round = 0  # of questions; those of an earlier one ask no more
        self._heard_ns: TimeNs = 0
        self._has_news = False
        self._is_started = False  # a heartbeat from before the NMT start may still be under way
        self._has_booted = False
        self._nmt_state = OPERATIONAL
        self._toggle: int | None = None
        self._toggle_stuck = False
        self._limit_ns = settings.heartbeat_ns or settings.guard_ns * settings.life_factor
        link.network.subscribe(self._id, self._on_error_control)

    def begin(self) -> None:
        """Watch from now on; what came during the start-up does not count."""
        self._is_watching = True
        self._heard_ns = self._clock.now_ns
        self._has_booted, self._nmt_state = False, OPERATIONAL
        self._is_started = False
        self._toggle, self._toggle_stuck = None, False
        self._link.begin()
        if self._settings.guard_ns:
            self._round += 1
            self._guard(self._round)

    def end(self) -> None:
        """Ask no more."""
        self._is_watching = False

    def _guard(self, number: int) -> None:
        if self._is_watching and number == self._round:
            self._link.network.send_message(self._id, ONE_BYTE, remote=True)
            due_ns = self._clock.now_ns + self._settings.guard_ns
            self._clock.call_at(due_ns, Phase.APPLICATION, partial(self._guard, number))

    def _on_error_control(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if not self._is_watching or len(data) != 1:
            return
        self._heard_ns, self._has_news = self._clock.now_ns, True
        state = data[0] & ~TOGGLE
        if self._settings.guard_ns:
            toggle = data[0] & TOGGLE
            self._toggle_stuck = self._toggle == toggle
            self._toggle = toggle
        if data[0] == BOOT_UP:
            self._has_booted = True
            self._link.forget()
        elif state in NMT_STATES and (state == OPERATIONAL or self._is_started):
            self._nmt_state = state
            self._is_started = True

    def communication(self) -> Alarm | None:
        """Return what is wrong with the connection, None when nothing is.

        Alarm 900024 (restarted), 900034 (not operational), 900023 (silent), 900029 (its position
        has jumped).
        """
        link, settings = self._link, self._settings
        if not (self._has_news or self._limit_ns or link.jump_mm is not None):
            return None
        if self._has_booted:
            return Alarm(900024, axis=link.name, node=link.node_id)
        if self._nmt_state != OPERATIONAL:
            state = NMT_STATES[self._nmt_state]
            return Alarm(900034, axis=link.name, node=link.node_id, state=state)
        if self._limit_ns:
            silent_ns = self._clock.now_ns - self._heard_ns
            if silent_ns > self._limit_ns or self._toggle_stuck:
                return Alarm(
                    900023,
                    axis=link.name,
                    node=link.node_id,
                    what="node guarding" if settings.guard_ns else "heartbeat",
                    ms=silent_ns // MS,
                )
        return jump_alarm(link)
