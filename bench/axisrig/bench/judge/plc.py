"""What passed between the program and the PLC side: stops, new starts, functions, variables."""

from axisrig.bench.machine.machine import Machine
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import S, TimeNs


def plc_side(machine: Machine) -> list[tuple[TimeNs, str, str]]:
    """Return instant, words and place of each, in the order in which they were carried out."""
    events = [event for event in machine.channel.plc.events if event.time_ns <= machine.end_ns]
    events.sort(key=lambda event: event.time_ns)  # a new start is noted with its stop
    return [(event.time_ns, _words(event), _place(event)) for event in events]


def _words(event: PlcEvent) -> str:
    match event.command:
        case canon.ProgramStop(optional=optional):
            what = "started again" if event.starts_again else "stop"
            return f"{'M1' if optional else 'M0'}: {what}"
        case canon.TechnologyFunction(word=word):
            return f"{word} to the PLC"
        case canon.ExternalWrite(name=name, value=value):
            return f"V.E.{name} = {value:.15g} to the PLC"
        case PlcAction(words=words):
            return words


def _place(event: PlcEvent) -> str:
    command = event.command
    return command.place if isinstance(command, PlcAction) else command.block.place


def plc_log(machine: Machine) -> list[str]:
    """Return a line for each, and one for every action of the PLC side that has not come."""
    lines = [
        f"{time_ns / S:.3f} s: {words} ({place})" for time_ns, words, place in plc_side(machine)
    ]
    return lines + machine.plc_side.not_come()
