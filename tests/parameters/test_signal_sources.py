"""The table of signal sources: what FCT-C4 7 and 8.2.2 say of each."""

from axisrig.bench.record.signal_sources import AT_PLC, AT_SIGNAL, HELD, STAMPED
from axisrig.kernel.measuring.rules import OF_PLC, inputs_of
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES
from axisrig.kernel.parameters.signal_sources import SOURCES, latched


def test_who_latches() -> None:
    """7.1 and 7.5: the PLC; 7.2: the drive, at a probe that the PLC switches; 7.4: hardware."""
    assert set(AT_SIGNAL) == {"PLC", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL"}
    assert (STAMPED, HELD) == ("PLC_TIMESTAMP", "PLC_EXT_LATCH_CONTROL")
    assert set(AT_PLC) == {*AT_SIGNAL, STAMPED}
    assert set(OF_PLC) == {*AT_PLC, "EXT_PROBE_WITH_DRIVE"}
    assert set(latched("drive")) == {"DRIVE", "DRIVE_TYPE_DEFAULT", "EXT_PROBE_WITH_DRIVE"}
    assert latched("none") == ("FIXED_STOP",)


def test_inputs_and_drive_types() -> None:
    """8.2.2: external hardware has inputs up to 255, a drive two; every drive is of the table."""
    assert {source: inputs_of(source) for source in SOURCES} == {
        source: 255 if source == "PLC_EXT_LATCH_CONTROL" else 2 for source in SOURCES
    }
    for source in SOURCES.values():
        assert set(source.drive_types) <= set(DRIVE_TYPES)
    without = {name for name, kind in SOURCES.items() if set(kind.drive_types) != set(DRIVE_TYPES)}
    assert without == {"DRIVE", "EXT_PROBE_WITH_DRIVE", "FIXED_STOP"}
