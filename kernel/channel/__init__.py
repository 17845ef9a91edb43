"""The NC channel: a program, its axes, and the cycle that ties them to the bus."""

from kernel.channel.channel import Channel
from kernel.channel.settings import AxisSettings, CycleTiming
from kernel.channel.state import ChannelState

__all__ = ["AxisSettings", "Channel", "ChannelState", "CycleTiming"]
