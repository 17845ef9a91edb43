"""Hands level and time stamp of a digital input over for axis Z: source PLC_TIMESTAMP.

V.E.STAMP_LATE of the plan makes a mistake on purpose: the stamp is written so many cycles after the
signal. V.E.BOTH_LATE hands both over so many cycles late. Without them both are written at once.
"""

from collections import deque

from axisrig.bench.machine.plc.hli import Hli, Inputs

AXIS = "Z"
CYCLES_MAX = 1000


class ProbeTimestamp:
    """FCT-C4 7.5: state and stamp of the terminal in the same cycle."""

    def __init__(self) -> None:
        self._past: deque[tuple[bool, int]] = deque(maxlen=CYCLES_MAX)

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Copy input 1 and the stamp of the edge to its level to the two units."""
        channel, control = inputs.channel[1], hli.ax[AXIS].lr_mc_control
        stamp_ns = channel.latch_pos_ns if channel.input else channel.latch_neg_ns
        self._past.append((channel.input, stamp_ns))
        signal, _ = self._ago(int(hli.ve.get("BOTH_LATE", 0)))
        _, stamp_ns = self._ago(int(hli.ve.get("STAMP_LATE", hli.ve.get("BOTH_LATE", 0))))
        is_there = inputs.wc_state == 0
        control.probing_signal.enable_w = control.timestamp.enable_w = is_there
        control.probing_signal.command_w, control.timestamp.command_w = signal, stamp_ns

    def _ago(self, cycles: int) -> tuple[bool, int]:
        """Return what was read so many cycles ago, the oldest if it is younger."""
        return self._past[max(0, len(self._past) - 1 - cycles)]
