"""What passed between the program and the PLC side: stops, new starts, functions, variables."""

from bench.rig.machine import Machine
from kernel.clock import S, TimeNs
from kernel.nc.canon import Block


def plc_side(machine: Machine) -> list[tuple[TimeNs, str, Block]]:
    """Return instant, words and block of each, in the order in which they were carried out."""
    pauses = machine.channel.pauses
    order = {id(command): at for at, command in enumerate(machine.channel.passed_to_plc)}
    found = []
    for stop_ns, start_ns, stop in pauses.stops:
        word = "M1" if stop.optional else "M0"
        found.append((stop_ns, order[id(stop)], f"{word}: stop", stop.block))
        if start_ns <= machine.end_ns:
            found.append((start_ns, order[id(stop)], f"{word}: started again", stop.block))
    for time_ns, told in pauses.told:
        words = f"{told.letter}{told.number} to the PLC"
        found.append((time_ns, order[id(told)], words, told.block))
    for time_ns, write in machine.channel.external.writes:
        words = f"V.E.{write.name} = {write.value:.15g} to the PLC"
        found.append((time_ns, order[id(write)], words, write.block))
    found.sort(key=lambda item: item[:2])
    return [(time_ns, words, block) for time_ns, _, words, block in found]


def plc_log(machine: Machine) -> list[str]:
    """Return a line for each."""
    return [
        f"{time_ns / S:.3f} s: {words} ({block.place})"
        for time_ns, words, block in plc_side(machine)
    ]
