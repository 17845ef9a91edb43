"""What the drives of a channel move, as far as the cycle of the channel has to do with it."""

from typing import Protocol

from axisrig.kernel.time.clock import TimeNs


class Mechanics(Protocol):
    """The axes and sensors at the drives. The channel learns no value of them."""

    def advance_to(self, sync_ns: TimeNs) -> None:
        """Be at the instant of the last SYNC: observers look at the mechanics of this cycle."""

    def has_come_to_rest(self) -> bool:
        """Return whether the axes are at rest; asked in every cycle from the end of a run on."""


class NoMechanics:
    """Nothing is simulated here: nothing is waited for."""

    def advance_to(self, sync_ns: TimeNs) -> None:
        """Do nothing."""

    def has_come_to_rest(self) -> bool:
        """Always at rest: nothing moves."""
        return True
