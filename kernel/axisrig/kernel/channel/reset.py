"""A reset of the channel: the program ends, the axes rest, the drives are in operation again.

The axes stop on the path as an alarm of class 4 stops them, runs end without a result, distance
controls are off with their offset kept. Sources: FCT-M3 6 and 12.8.4; TF527x kernel API 402223627.
"""

from collections.abc import Callable, Sequence

from axisrig.kernel.channel.path.monitor import PowerUp
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import CycleTiming
from axisrig.kernel.channel.reactions import Reactions
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.power import Power


class Reset:
    """Carries out the resets of a channel.

    ends: what ends what is under way, in their order. leaves: what changes the positions of axes at
    rest: they contain what distance control has superposed, and slaves are axes again. lead_back:
    leads drives out of a homing that has not come to its end, and says whether all are.
    """

    def __init__(
        self,
        links: Sequence[Drive],
        timing: CycleTiming,
        path: Path,
        reactions: Reactions,
        ends: Sequence[Callable[[], None]],
        leaves: Sequence[Callable[[], None]],
        lead_back: Callable[[], bool],
    ) -> None:
        self._links, self._timing, self._path = links, timing, path
        self._reactions, self._ends, self._leaves = reactions, tuple(ends), tuple(leaves)
        self._lead_back = lead_back
        self._power_up = PowerUp(links, timing)

    def begin(self) -> None:
        """End everything; the axes brake."""
        for end in self._ends:
            end()
        self._power_up = PowerUp(self._links, self._timing, resets_faults=True)

    def go_on(self) -> bool:
        """Do one cycle while the set positions rest; return whether every drive is in operation.

        Faults are acknowledged. An axis whose drive has left operation, or was led without its
        actual position, stays where it is.
        Raises Alarm 900005 and 900008 as the start does, 900011 and 900200 for a homing
        that is broken off.
        """
        self._reactions.reset()
        for leave in self._leaves:
            leave()
        for link in self._links:
            if link.power is not Power.OPERATING or link.runs_open:
                self._path.put(link.name, link.place_mm)
                link.close_loop()
        is_back = self._lead_back()
        return self._power_up.step() and is_back
