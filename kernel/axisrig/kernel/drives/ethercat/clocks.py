"""Distributed clocks as the master sets them up: delays, offsets, and whether each clock follows.

A frame that writes 0900 latches the receive times of all slaves. On a line the delay from one slave
to the next is half of what its loop takes longer than the next one's, which holds where both ways
take equally long. The master is the source of time: system time 0 is the begin of the run, and the
first slave with a clock is the reference that hands it on (FRMW).
"""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_station
from axisrig.kernel.drives.ethercat.steps import (
    Ask,
    Steps,
    read_register,
    value_of,
    write_register,
)
from axisrig.kernel.profiles.ethercat.tables import Command, address_of
from axisrig.kernel.time.clock import Clock, TimeNs

TIME_MASK: Final = 0xFFFF_FFFF
AMOUNT_MASK: Final = 0x7FFF_FFFF
HAS_CLOCK: Final = 1 << 2  # of FEATURES
SPEED_START: Final = (0x1000).to_bytes(2, "little")  # resets the filters of the clock
SYSTEM_TIME: Final = address_of("SYSTEM_TIME")


def has_clock(station: int) -> Steps:
    """Return whether a slave has a distributed clock."""
    features = value_of((yield read_register(station, "FEATURES", 2)))
    return features is not None and bool(features & HAS_CLOCK)


def set_clocks(stations: Sequence[int], clock: Clock, *, writes_delay: bool) -> Steps:
    """Write offset and delay of each slave, those on the line in their order.

    Returns the stations that did not answer.
    """
    latched_ns = clock.now_ns
    yield Ask([Datagram(Command.BWR, address_of("RECEIVE_TIMES") << 16, bytes(4))])
    loops, local, silent = list[TimeNs](), list[int](), list[int]()
    for station in stations:
        times = yield read_register(station, "RECEIVE_TIMES", 8)
        own = value_of((yield read_register(station, "RECEIVE_TIME", 8)))
        if not times or times[0].counter != 1 or own is None:
            silent.append(station)
            continue
        there, back = (int.from_bytes(times[0].data[at : at + 4], "little") for at in (0, 4))
        loops.append(back - there & TIME_MASK if station != stations[-1] else 0)
        local.append(own)
    if silent:
        return silent
    delay_ns = 0
    for number, station in enumerate(stations):
        if number:
            delay_ns += (loops[number - 1] - loops[number]) // 2
        offset = latched_ns + delay_ns - local[number]
        yield write_register(
            station, "SYSTEM_TIME_OFFSET", (offset & (1 << 64) - 1).to_bytes(8, "little")
        )
        delay = delay_ns if writes_delay else 0
        yield write_register(station, "SYSTEM_TIME_DELAY", delay.to_bytes(4, "little"))
        yield write_register(station, "SPEED_COUNTER_START", SPEED_START)
    return []


def distribution(reference: int, time_ns: TimeNs) -> list[Datagram]:
    """Return the datagrams that hand the time of the master on, as masters do in each cycle."""
    address, time = at_station(reference, SYSTEM_TIME), time_ns & TIME_MASK
    return [
        Datagram(Command.FPWR, address, time.to_bytes(4, "little")),
        Datagram(Command.FRMW, address, bytes(4)),
    ]


def difference(station: int) -> Datagram:
    """Return the question how far the clock of a slave is from the time that it gets."""
    address = at_station(station, address_of("SYSTEM_TIME_DIFFERENCE"))
    return Datagram(Command.FPRD, address, bytes(4))


def differences_ns(answers: Sequence[Answer]) -> list[int | None]:
    """Return the amounts of some differences, ns; None where a slave did not answer."""
    return [
        int.from_bytes(each.data, "little") & AMOUNT_MASK if each.counter == 1 else None
        for each in answers
    ]


def begin_sync(station: int, start_ns: TimeNs, period_ns: TimeNs) -> Steps:
    """Let SYNC0 begin at a system time and come again with each period."""
    yield write_register(station, "ACTIVATION", b"\0")
    yield write_register(station, "CYCLIC_CONTROL", b"\0")
    yield write_register(station, "START_TIME", start_ns.to_bytes(8, "little"))
    yield write_register(station, "SYNC0_CYCLE", period_ns.to_bytes(4, "little"))
    yield write_register(station, "ACTIVATION", b"\3")
