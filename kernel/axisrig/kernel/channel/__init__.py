"""The NC channel: a program, its axes, and the cycle that ties them to the bus."""

from axisrig.kernel.channel.channel import Channel
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings, CycleTiming
from axisrig.kernel.channel.state import ChannelState
from axisrig.kernel.channel.surroundings import Surroundings

__all__ = [
    "AxisSettings",
    "Channel",
    "ChannelSettings",
    "ChannelState",
    "CycleTiming",
    "Surroundings",
]
