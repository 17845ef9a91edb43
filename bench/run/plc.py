"""What passed between the program and the PLC side: stops, new starts, functions, variables."""

from bench.rig.machine import Machine
from kernel.clock import S, TimeNs
from kernel.nc.canon import Block


def plc_side(machine: Machine) -> list[tuple[TimeNs, str, Block]]:
    """Return instant, words and block of each, in the order of time."""
    pauses = machine.channel.pauses
    found = []
    for stop_ns, start_ns, stop in pauses.stops:
        word = "M1" if stop.optional else "M0"
        found.append((stop_ns, f"{word}: stop", stop.block))
        if start_ns <= machine.end_ns:
            found.append((start_ns, f"{word}: started again", stop.block))
    for time_ns, told in pauses.told:
        found.append((time_ns, f"{told.letter}{told.number} to the PLC", told.block))
    for time_ns, write in machine.channel.external.writes:
        words = f"V.E.{write.name} = {write.value:.15g} to the PLC"
        found.append((time_ns, words, write.block))
    return sorted(found, key=lambda item: item[0])


def plc_log(machine: Machine) -> list[str]:
    """Return a line for each."""
    return [
        f"{time_ns / S:.3f} s: {words} ({block.place})"
        for time_ns, words, block in plc_side(machine)
    ]
