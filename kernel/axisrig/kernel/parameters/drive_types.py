"""Drive types of P-AXIS-00020 (`drive_types.csv`): what each has, and what simulates it."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Final

from axisrig.kernel.parameters.signal_sources import SOURCES

DEFAULT_MODE: Final = "DRIVE_DEFAULT"
DRIVE_MODE, CNC_MODE = "DRIVE_POSITION_CONTROL", "CNC_POSITION_CONTROL"
DSC_MODE: Final = "DSC_POSITION_CONTROL"
_MODES: Final = {"drive": DRIVE_MODE, "cnc": CNC_MODE, "dsc": DSC_MODE}


@dataclass(frozen=True)
class DriveType:
    """A row of the table.

    family: the folder of `kernel/drives` and `bench/drive` that speaks it, empty where none does;
    why: why none does. latch: in which form its drives latch a position, empty where they do not.
    inputs: probing inputs at most (P-AXIS-00517). may_change_input: #MEAS may choose another one,
    which for others would take several parameters of the drive (70390). edges: those that it
    latches. distance_control: P-AXIS-00328 may be on. edge_banding: it has that input
    (P-AXIS-00539). fixed_stop: numbers of the parameters of a run to a fixed stop that it has.
    older_switches: numbers of the switches P-AXIS-00115 to 00117 that count. position_loop: where
    it may be closed, `telegram` first where the telegram decides it, else the usual place first.
    access: what #DRIVE and #IDENT write to, empty where nothing.
    """

    number: int
    name: str
    family: str
    why: str
    latch: str
    inputs: int
    may_change_input: bool
    edges: tuple[str, ...]
    distance_control: bool
    edge_banding: bool
    fixed_stop: tuple[str, ...]
    older_switches: tuple[str, ...]
    position_loop: tuple[str, ...]
    access: str

    def offers(self, signal: str) -> bool:
        """Whether it has a source of the probing signal (P-AXIS-00516).

        DRIVE_TYPE_DEFAULT is a source of each, whatever it is there.
        """
        if signal == "DRIVE_TYPE_DEFAULT":
            return True
        latched = SOURCES[signal].latched
        if latched == "drive":
            return bool(self.latch)
        return latched != "none" or bool(self.fixed_stop)

    def inputs_of(self, signal: str) -> int | None:
        """Return the highest probing input with a source, None where it uses none."""
        source = SOURCES[signal]
        # An external probe that the PLC switches has two inputs with each type (FCT-C4 8.2.2)
        is_of_drive = source.latched == "drive" and not source.needs_plc
        return self.inputs if is_of_drive else source.inputs

    @property
    def modes(self) -> tuple[str, ...]:
        """What P-AXIS-00320 may say of it."""
        return (DEFAULT_MODE, *(_MODES[place] for place in self.position_loop if place in _MODES))


def _read() -> Mapping[int, DriveType]:
    text = resources.files(__package__).joinpath("drive_types.csv").read_text(encoding="utf-8")
    found = [
        DriveType(
            number=int(row["number"]),
            name=row["name"],
            family=row["family"],
            why=row["why"],
            latch=row["latch"],
            inputs=int(row["inputs"]),
            may_change_input=row["may_change_input"] == "yes",
            edges=tuple(row["edges"].split()),
            distance_control=row["distance_control"] == "yes",
            edge_banding=row["edge_banding"] == "yes",
            fixed_stop=tuple(row["fixed_stop"].split()),
            older_switches=tuple(row["older_switches"].split()),
            position_loop=tuple(row["position_loop"].split()),
            access=row["access"],
        )
        for row in csv.DictReader(text.splitlines())
    ]
    return {row.number: row for row in found}


DRIVE_TYPES: Final = _read()
SIMULATED: Final = tuple(row.number for row in DRIVE_TYPES.values() if row.family)
CANOPEN: Final = DRIVE_TYPES[8]
