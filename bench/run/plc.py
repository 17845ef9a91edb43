"""What passed between the program and the PLC side: stops, new starts, functions, variables."""

from bench.rig.machine import Machine
from kernel.channel.external import PlcEvent
from kernel.clock import S, TimeNs
from kernel.nc import canon
from kernel.nc.canon import Block


def plc_side(machine: Machine) -> list[tuple[TimeNs, str, Block]]:
    """Return instant, words and block of each, in the order in which they were carried out."""
    events = [event for event in machine.channel.plc_events if event.time_ns <= machine.end_ns]
    events.sort(key=lambda event: event.time_ns)  # a new start is noted with its stop
    return [(event.time_ns, _words(event), event.command.block) for event in events]


def _words(event: PlcEvent) -> str:
    match event.command:
        case canon.ProgramStop(optional=optional):
            what = "started again" if event.starts_again else "stop"
            return f"{'M1' if optional else 'M0'}: {what}"
        case canon.TechnologyFunction(letter=letter, number=number):
            return f"{letter}{number} to the PLC"
        case canon.ExternalWrite(name=name, value=value):
            return f"V.E.{name} = {value:.15g} to the PLC"


def plc_log(machine: Machine) -> list[str]:
    """Return a line for each."""
    return [
        f"{time_ns / S:.3f} s: {words} ({block.place})"
        for time_ns, words, block in plc_side(machine)
    ]
