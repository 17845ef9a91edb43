"""Where a fault of a rig can be, its keys, and the table of faults."""

from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.faults import (
    TERMINAL_TELEGRAMS,
    fault_keys,
    fault_kinds,
    fault_moments,
    faults_table,
    read_faults,
)
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def allowed(rig: str, kind: str) -> set[str]:
    with pytest.raises(UserError) as caught:
        read_faults(kind, "nowhere", read_rig(RIGS / rig)[0])
    return set((caught.value.allowed or "").split(", "))


PLACES = {
    # rig: signal, sensor, plc, terminal; telegrams of a terminal
    "probe-xyz.toml": ("probe", "", "", "", False),
    "plc-drive-input.toml": ("probe", "", "plc", "", False),
    "plc-io-node.toml": ("probe", "", "plc", "", True),  # a node on CAN has no stamps
    "plc-timestamp.toml": ("probe", "", "plc", "terminal", False),
    "distance-xz.toml": ("", "gap", "", "", False),
    "distance-z-variable.toml": ("", "gap", "", "", False),
}


@pytest.mark.parametrize("rig", PLACES)
def test_a_fault_has_the_places_that_a_rig_has(rig: str) -> None:
    *own, has_node = PLACES[rig]
    kinds = ("probe_stick", "sensor_drift", "plc_lost", "clock_off")
    assert [", ".join(sorted(allowed(rig, kind))) for kind in kinds] == own
    axes = set(read_rig(RIGS / rig)[0].axis)
    buses = set(read_rig(RIGS / rig)[0].segment)
    assert (allowed(rig, "reset"), allowed(rig, "babble")) == (axes, buses)
    assert allowed(rig, "sync_loss") == axes | buses
    telegrams = allowed(rig, "drop")
    assert telegrams >= {f"{axis}.EMCY" for axis in axes} | {f"{bus}.SYNC" for bus in buses}
    assert (telegrams >= {f"terminal.{name}" for name in TERMINAL_TELEGRAMS}) is has_node


def test_a_fault_knows_axis_and_bus_of_its_place() -> None:
    for rig, kind, target, place in (
        ("plc-io-node.toml", "drop", "terminal.TPDO1", ("", "can1", "TPDO1")),
        ("plc-io-node.toml", "drop", "can1.SYNC", ("", "can1", "SYNC")),
        ("plc-io-node.toml", "drop", "Z.RPDO1", ("Z", "", "RPDO1")),
        ("probe-xyz.toml", "babble", "can2", ("", "can2", "")),
        ("plc-timestamp.toml", "clock_off", "terminal", ("", "", "")),
        ("plc-timestamp.toml", "probe_stick", "probe", ("", "", "")),
    ):
        (fault,) = read_faults(kind, target, read_rig(RIGS / rig)[0])
        assert (fault.axis, fault.segment, fault.telegram) == place, target


@pytest.mark.parametrize(
    "others", [[], ["probe_stick=probe"], ["power_loss=Z", "probe_stick=probe"]]
)
def test_a_fault_that_its_carrier_has_not_is_refused_behind_any_other(others: list[str]) -> None:
    """`drop` is of CAN, `power_loss` of any drive, `probe_stick` of a sensor of any rig."""
    rig = RIGS / "probe-z-ethercat.toml"

    def checked(*faults: str) -> None:
        columns = [(parse_assignment(f"fault:{fault}"), as_written) for fault in faults]
        check_rig(read_settings(*read_rig(rig), columns))

    checked(*others)
    with pytest.raises(UserError, match="no such faults of segments of the kind ethercat"):
        checked(*others, "drop=Z.TPDO1")


def test_what_a_key_of_a_fault_may_have_is_named_for_its_kind() -> None:
    rig = read_rig(RIGS / "probe-z.toml")[0]
    for text, has_moments in (("at=soon", True), ("for=soon", False), ("p=2", False)):
        with pytest.raises(UserError) as caught:
            read_faults("drop", f"Z.TPDO1 {text}", rig)
        assert ("motion" in str(caught.value.allowed)) is has_moments, text
        assert caught.value.value == text.partition("=")[2]


def test_the_table_of_faults_has_every_kind_with_its_targets_and_keys() -> None:
    lines = faults_table().splitlines()
    for kind in fault_kinds().values():
        keys = " ".join(
            f"{key}={kind.defaults[key]}" if key in kind.defaults else key for key in kind.keys
        )
        at = lines.index(f"{kind.name}  ({' or '.join(kind.targets)})  {keys}")
        assert lines[at + 1] == f"    {kind.meaning}"
    for name in (*fault_keys(), *fault_moments()):
        assert any(line.startswith(f"  {name}  ") for line in lines), name
