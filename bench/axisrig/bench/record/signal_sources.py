"""Sources of a measuring signal by how a recording shows their latch (P-AXIS-00516)."""

from typing import Final

from axisrig.kernel.parameters.signal_sources import latched

AT_PLC: Final = latched("signal", "stamp", "held")
"""The PLC hands the signal over."""
AT_SIGNAL: Final = latched("signal", "held")
"""Of these the position is that of the cycle that sees the signal, or comes with it."""
(HELD,) = latched("held")
(STAMPED,) = latched("stamp")
