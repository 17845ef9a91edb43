"""The NC channel: one program, its axes, and the cycle that ties them to the bus."""

from kernel.channel.channel import Channel, ChannelState
from kernel.channel.settings import AxisSettings, CycleTiming

__all__ = ["AxisSettings", "Channel", "ChannelState", "CycleTiming"]
