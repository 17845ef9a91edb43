"""What passed between the program and the PLC side: stops, new starts, functions, variables."""

from collections.abc import Sequence

from axisrig.bench.record.facts import PlcNote
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import TimeNs


def plc_notes(events: Sequence[PlcEvent], end_ns: TimeNs) -> list[PlcNote]:
    """Return what passed until `end_ns`, in the order in which it was carried out."""
    passed = [event for event in events if event.time_ns <= end_ns]
    passed.sort(key=lambda event: event.time_ns)  # a new start is noted with its stop
    return [PlcNote(event.time_ns, _words(event), _place(event)) for event in passed]


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
