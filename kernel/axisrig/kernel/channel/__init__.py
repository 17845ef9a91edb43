"""The NC channel: a program, its axes, and the cycle that ties them to the bus."""

from axisrig.kernel.channel.channel import Channel
from axisrig.kernel.channel.path.settings import AxisSettings, CycleTiming
from axisrig.kernel.channel.state import ChannelState

__all__ = ["AxisSettings", "Channel", "ChannelState", "CycleTiming"]
