"""Single axes beside the common path: independent motion, couplings, homing."""

from axisrig.kernel.channel.axes.coupling import Couplings
from axisrig.kernel.channel.axes.single_axes import SingleAxes

__all__ = ["Couplings", "SingleAxes"]
