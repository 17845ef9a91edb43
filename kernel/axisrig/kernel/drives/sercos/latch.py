"""The latch of a SERCOS drive as the control sees it, through real-time bits and the AT.

An enable bit at 1 arms it; what it has latched stays until the bit is 0. A run counts a latch only
when the bit of the done measurement was 0 after the last clearing, so that a value of an earlier
latch cannot be one of this run. Source: FCT-C4 6.1, AX5000 and AX2000 ident descriptions.
"""

from typing import Final

from axisrig.kernel.drives.sercos.service_channel import Done, ServiceChannel, SoeError
from axisrig.kernel.drives.sercos.settings import RealTimeBits
from axisrig.kernel.profiles.sercos.service import Element, command_states
from axisrig.kernel.profiles.sercos.words import PROBE_COMMAND, ProbeIdents

RUNNING: Final = command_states()["RUNNING"]


class SercosLatch:
    """One axis. bits: in use. increments: latched, None while no latch is reported.

    idents: of probe and edge. enable: mask of S-0-0134 for the next MDT. is_ordered: it has
    been ordered on and not off again. echo_cycles: from an MDT to the AT that the drive has made
    after it.
    """

    def __init__(
        self,
        bits: RealTimeBits,
        drive: int,
        idents: ProbeIdents,
        channel: ServiceChannel,
        echo_cycles: int,
        *,
        proves: bool,
    ) -> None:
        self._echo = echo_cycles
        self._bits, self._drive, self._channel, self._proves = bits, drive, channel, proves
        self._idents = idents
        self.is_ordered = False
        self.enable = 0
        self._age = self._echo  # ATs since the enable bit changed
        self._has_bit = False
        self._was_clear = False
        self._present = 0
        self.increments: int | None = None
        self.speed_increments = 0
        self._last_actual: int | None = None
        self._probing: bool | None = None
        self._proof: int | None = None
        self._asks = 0

    def take(self, status: int, value: int | None, actual: int) -> None:
        """Take the AT of a cycle."""
        self._age = min(self._age + 1, self._echo)
        self._has_bit = bool(status & self._bits.latched)
        moved = 0 if self._last_actual is None else actual - self._last_actual
        self._last_actual = actual
        if not self._has_bit and self._age >= self._echo:
            self._was_clear = True
        if self.has_latched and self.increments is None and value is not None:
            self.increments, self.speed_increments = value, moved

    @property
    def is_clear(self) -> bool:
        """Whether the drive shows neither an enabled latch nor a done measurement."""
        return not self.enable and self._age >= self._echo and not self._has_bit

    @property
    def is_armed(self) -> bool:
        """Whether the drive has had the enable bit in an MDT before its AT."""
        return bool(self.enable) and self._age >= self._echo

    @property
    def has_latched(self) -> bool:
        """Whether the drive reports a done measurement of this run."""
        return self.is_ordered and self.is_armed and self._was_clear and self._has_bit

    def arm(self) -> None:
        """Set the enable bit; and ask whether the probing cycle runs, without which none comes."""
        self._was_clear = self._was_clear and not self._has_bit
        self.is_ordered = True
        self._set(self._bits.enable)
        self.increments, self._proof, self._probing = None, None, None
        self._asks += 1
        number = self._asks
        self._channel.read(
            self._drive,
            PROBE_COMMAND,
            Element.DATA_STATE,
            lambda found: self._note_probing(number, found),
        )

    def _note_probing(self, number: int, found: bytes | SoeError) -> None:
        if number == self._asks:
            if isinstance(found, SoeError):
                self._probing = False
            else:
                self._probing = int.from_bytes(found, "little") == RUNNING

    def disarm(self) -> None:
        """Clear the enable bit."""
        self.is_ordered = False
        self._set(0)

    def _set(self, enable: int) -> None:
        if enable != self.enable:
            self.enable, self._age = enable, 0
            if not enable:
                self._was_clear = False

    @property
    def is_prepared(self) -> bool:
        """Whether the probing cycle is known to run."""
        return bool(self._probing)

    @property
    def is_refused(self) -> bool:
        """Whether the drive has said that its probing cycle does not run."""
        return self._probing is False

    def is_confirmed(self) -> bool:
        """Whether the drive has a done measurement and the value of the AT by its service channel.

        Asks once, for the done measurement first: the value does not change behind it.
        """
        if self.increments is None:
            return False
        if not self._proves:
            return True
        if self._proof is None:
            self._proof = -1
            number = self._asks
            self._ask(self._idents.latched, lambda found: self._note_latched(number, found))
        return self._proof == 1

    def _ask(self, ident: int, done: Done) -> None:
        self._channel.read(self._drive, ident, Element.VALUE, done)

    def _note_latched(self, number: int, found: bytes | SoeError) -> None:
        if number == self._asks and not isinstance(found, SoeError) and found[0] & 1:
            self._ask(self._idents.value, lambda found: self._note_proof(number, found))

    def _note_proof(self, number: int, found: bytes | SoeError) -> None:
        if number == self._asks and not isinstance(found, SoeError):
            value = int.from_bytes(found, "little", signed=True)
            self._proof = int(value == self.increments)
