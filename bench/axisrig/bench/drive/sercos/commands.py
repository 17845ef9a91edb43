"""Procedure commands of a drive: written 3 they run, written 0 they are cancelled.

Source: IndraDrive functions on procedure commands (docs/sercos.md): 7 runs, 3 done, F failed; the
change bit of S-0-0135 comes with the end, and goes when the master cancels.
"""

from collections.abc import Callable, Mapping
from typing import Final

from axisrig.bench.drive.sercos.idents import Idents
from axisrig.bench.drive.sercos.service_channel import STATES
from axisrig.kernel.profiles.sercos.service import RUN

DONE, FAILED, RUNNING = STATES["DONE"], STATES["FAILED"], STATES["RUNNING"]
INTERRUPTED = STATES["INTERRUPTED"]

Run = Callable[[], int]
"""Begins a command; returns its data state then."""


class Commands:
    """The commands of a drive. run: by ident. cancelled(ident): called when one is cancelled."""

    def __init__(
        self, idents: Idents, run: Mapping[int, Run], cancelled: Callable[[int], None]
    ) -> None:
        self._idents, self._run, self._cancelled = idents, run, cancelled
        self.known: Final = frozenset(run)

    def written(self, ident: int) -> None:
        """Act on a write that was taken."""
        if self._idents.number(ident) == RUN:
            self._idents.table[ident].state = self._run[ident]()
        else:
            self._cancelled(ident)

    def end(self, ident: int, state: int) -> None:
        """Let a command that runs have ended."""
        if self._idents.table[ident].state == RUNNING:
            self._idents.table[ident].state = state

    @property
    def has_changed(self) -> bool:
        """Whether one has ended and is not cancelled yet: the change bit."""
        table = self._idents.table
        return any(table[ident].state in (DONE, FAILED) for ident in self.known)
