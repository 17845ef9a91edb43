"""The low-pass: a cascade of equal first-order stages, so it never swings (critically damped)."""

import math

from axisrig.kernel.time.clock import TimeNs, ns_to_seconds


class LowPass:
    """Order n: n stages 1/(1 + s/w0) with w0 = 2 pi f0, n times 20 dB per decade from f0 on.

    The bilinear transformation bent to f0 gives each stage, with g = tan(pi f0 T),
    y(k) = y(k-1) + 2g/(1+g) ((x(k) + x(k-1))/2 - y(k-1)): -3 dB at f0, and possible only for f0
    below 0.5/T (Oppenheim and Schafer, Discrete-Time Signal Processing, 7.2.2).
    """

    def __init__(self, order: int, f0_hz: float, period_ns: TimeNs) -> None:
        slope = math.tan(math.pi * f0_hz * ns_to_seconds(period_ns))
        self._share = 2 * slope / (1 + slope)
        # No weights of a mean, whose sum is 1
        self.character: tuple[float, ...] = (float(order), self._share)
        self._inputs_mm = [0.0] * order
        self._outputs_mm = [0.0] * order

    def restart(self, value_mm: float) -> None:
        """Put every stage to rest at a value."""
        self._inputs_mm = [value_mm] * len(self._inputs_mm)
        self._outputs_mm = [value_mm] * len(self._outputs_mm)

    def step(self, value_mm: float) -> float:
        """Take the value of this cycle through all stages."""
        for stage, before_mm in enumerate(self._inputs_mm):
            self._inputs_mm[stage] = value_mm
            out_mm = self._outputs_mm[stage]
            value_mm = out_mm + self._share * ((value_mm + before_mm) / 2 - out_mm)
            self._outputs_mm[stage] = value_mm
        return value_mm
