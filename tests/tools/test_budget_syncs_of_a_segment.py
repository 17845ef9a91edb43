"""A budget where the SYNC of the axis is later than that of the PLC: which one took the sample.

SYNCs end at 48 us and each ms after, that of the axis 64 us later; the CNC has its cycle at 600 us.
"""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.signal_sources import HELD
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.bench.tools.budget.instants import Instants, instants_at_plc
from axisrig.kernel.time.clock import MS, US


class Observed:
    """SYNCs that end at 48 us, those of the axis `late_us` later; no frames were recorded."""

    def __init__(self, late_us: int, **task: Any) -> None:
        values = {
            "period_ns": 4 * MS, "offset_ns": 1 * MS, "busy_ns": 1 * MS, "terminal_ns": 4 * MS,
            "terminal_offset_ns": 1 * MS,
        }  # fmt: skip
        self._late_ns = late_us * US
        self.facts: Any = SimpleNamespace(
            plc_task=PlcTaskRecord(**(values | task)),
            timing=SimpleNamespace(period_ns=MS, offset_ns=600 * US),
        )

    def time_ns(self, row: int) -> int:
        return row * MS + 48 * US

    def sync_ns(self, _axis: str, row: int) -> int:
        return self.time_ns(row) + self._late_ns

    def index_at(self, time_ns: int) -> int:
        return (time_ns - 48 * US) // MS

    def frame_ends_ns(self, *_: object) -> list[int]:
        return []


def touched(source: str, edge_us: int) -> Any:
    return SimpleNamespace(
        run=SimpleNamespace(sources={"Z": source}, begin_ns=0),
        edge_ns=edge_us * US,
        end_ns=60 * MS,
        edge_uncertainty_ns=0.0,
        edges=[[SimpleNamespace(time_ns=edge_us * US, level=True)]],
    )


def rig_of(program: str = "external_latch.py", position: float | None = 1.0) -> Any:
    drive = DriveTable(input_filter_us=0.0, input_delay_us=0.0)
    rig = SimpleNamespace(
        plc_task=SimpleNamespace(program=program),
        axis={"Z": SimpleNamespace(drive="servo", plant="z")},
        drive={"servo": drive},
    )
    return SimpleNamespace(rig=rig, external={} if position is None else {"POSITION": position})


def instants(observed: Observed, source: str, edge_us: int, settings: Any) -> Instants | None:
    track: Any = observed
    return instants_at_plc(track, touched(source, edge_us), "Z", settings)


@pytest.mark.parametrize("late_us", [0, 64])
def test_a_probe_at_a_terminal_is_sampled_by_no_drive_whatever_is_handed_over(
    late_us: int,
) -> None:
    """The PLC has it at 5 ms and is done at 6 ms, the CNC at 6.6 ms.

    Handed over is what the CNC has shown before 5 ms, at 4.6 ms: the SYNC at 4.048 ms.
    """
    at_terminal = Observed(late_us, probes=("probe",))
    row_ns = (48 + late_us) * US
    handed = instants(at_terminal, HELD, 1500, rig_of())
    assert handed == Instants(4 * MS + row_ns)
    for settings in (rig_of(position=None), rig_of(position=0.0), rig_of("other.py")):
        assert instants(at_terminal, HELD, 1500, settings) == Instants(6 * MS + row_ns)
    assert instants(at_terminal, "PLC", 1500, rig_of()) == Instants(6 * MS + row_ns)


@pytest.mark.parametrize(
    ("late_us", "edge_us", "sampled_ms"),
    [(0, 1048, 1), (0, 1049, 2), (64, 1048, 1), (64, 1049, 1), (64, 1112, 1), (64, 1113, 2)],
)
def test_a_drive_samples_its_input_at_the_sync_of_its_own_segment(
    late_us: int, edge_us: int, sampled_ms: int
) -> None:
    found = instants(Observed(late_us), "PLC", edge_us, rig_of())
    row_ns = (48 + late_us) * US
    assert found == Instants(6 * MS + row_ns, sampled_ms * MS + row_ns)


@pytest.mark.parametrize(
    ("edge_us", "plc_us", "value_ms"),
    # Sampled at 4.048 ms and shown at 4.6 ms: the PLC that began at 4.3 ms does not have it
    [
        (3500, 300, 9),
        (3500, 599, 9),
        (3500, 600, 10),
        (3500, 601, 6),
        (3500, 700, 6),
        (2500, 300, 5),
    ],
)
def test_the_plc_has_a_sample_when_the_cnc_has_shown_it(
    edge_us: int, plc_us: int, value_ms: int
) -> None:
    """A task of 4 ms takes 1 ms, then a cycle of the CNC; none has what comes as it begins."""
    found = instants(Observed(0, offset_ns=plc_us * US), "PLC", edge_us, rig_of())
    assert found is not None
    assert found.value_ns == value_ms * MS + 48 * US
