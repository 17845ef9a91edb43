"""Single axes: independent ones, couplings, exchange, homing, positions, distance control."""

from axisrig.kernel.nc.decoder.axes import (
    coupling,
    distance,
    exchange,
    homing,
    independent,
    positions,
)
from axisrig.kernel.nc.decoder.axes.distance import turns_channel
from axisrig.kernel.nc.decoder.axes.independent import (
    after_block,
    before_block,
    before_turning,
    synchronised,
    wait_for_all,
)
from axisrig.kernel.nc.decoder.axes.state import forbidden
from axisrig.kernel.nc.decoder.base.topic import Topic

__all__ = [
    "TOPIC",
    "after_block",
    "before_block",
    "before_turning",
    "forbidden",
    "synchronised",
    "turns_channel",
    "wait_for_all",
]

TOPIC = Topic(
    commands={
        "WAIT INDP": independent.wait,
        "SET AX LINK": coupling.define,
        "AX LINK": coupling.define,
        "ENABLE AX LINK": coupling.switch_on,
        "AX LINK ON": coupling.switch_on,
        "DISABLE AX LINK": coupling.switch_off,
        "AX LINK OFF": coupling.switch_off,
        "PUT AX": exchange.put,
        "CALL AX": exchange.call,
        "CHANNEL INIT": positions.initialise,
        "DIST CTRL": distance.channel_control,
    },
    axis_commands={
        "INDP_SYN": independent.move,
        "INDP_ASYN": independent.move,
        distance.NAME: distance.control,
    },
    takes_axes={"G74": homing.home},
)
