"""Two controllers send the same identifier at once: nobody loses arbitration.

They send on until their bits differ. Who sends recessive there sees dominant, a bit error. Source:
ISO 11898-1, error detection; Bosch CAN 2.0 part A, 6.1 and 6.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.frame import wire_bits


@dataclass(frozen=True)
class Collision:
    """How it ends.

    senders: those that sent to the end, all the same bits, or to the bit that destroyed the frame.
    silenced: error passive ones that saw their bit error before; their flags are recessive and
    nobody minds them. bit: 1 = SOF, None when the frame gets through. seen_by: names of those who
    saw the bit error.
    """

    senders: tuple[Controller, ...]
    silenced: tuple[Controller, ...]
    bit: int | None
    seen_by: frozenset[str]


def collide(contenders: Sequence[Controller]) -> Collision:
    """Let the first pending frames of `contenders` collide; same arbitration field in all."""
    alive = {port: wire_bits(port.pending[0][4]) for port in contenders}
    silenced: list[Controller] = []
    while len(set(alive.values())) > 1:
        texts = list(alive.values())
        place = next(i for i, levels in enumerate(zip(*texts, strict=False)) if len({*levels}) > 1)
        seers = [port for port, text in alive.items() if text[place] == "1"]
        if any(port.error_state is ErrorState.ACTIVE for port in seers):
            names = frozenset(port.port_name for port in seers)
            return Collision(tuple(alive), tuple(silenced), place + 1, names)
        silenced += seers
        for port in seers:
            del alive[port]
    return Collision(tuple(alive), tuple(silenced), None, frozenset())
