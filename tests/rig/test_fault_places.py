"""Where a fault of a rig can be, its keys, and the table of faults."""

import csv
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.faults import open_targets
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
    for key in fault_keys().values():
        (line,) = [
            text for text in lines if text.startswith(f"  {key.name}  ") and key.meaning in text
        ]
        default = f", default {key.default}" if key.default else ""
        ending = f" ({key.allowed}{default})" if key.allowed else ""
        assert line.endswith(f"{key.meaning}{ending}")
        assert ("default" in line.partition(key.meaning)[2]) is bool(key.default and key.allowed)


BUSES = Path(__file__).parents[2] / "bench" / "axisrig" / "bench" / "bus"


def _reactions(kind: str) -> list[dict[str, str]]:
    """Read what the tables of the carriers have of a kind: CAN, EtherCAT, cyclic segments."""
    found = []
    for carrier in ("can", "ethercat", "cyclic"):
        text = (BUSES / carrier / "fault_reactions.csv").read_text(encoding="utf-8")
        found += [row for row in csv.DictReader(text.splitlines()) if row["kind"] == kind]
    return found


@pytest.mark.parametrize("kind", fault_kinds())
def test_of_one_kind_each_example_has_all_that_follows_from_it(kind: str) -> None:
    """In the order of the table: what happens on the wire first, the measured value last."""
    head, *blocks = faults_table(kind).split("\n\n")
    assert head == f"{kind}: {fault_kinds()[kind].meaning}"
    rows = _reactions(kind)
    assert len(blocks) == len(rows)
    for block, row in zip(blocks, rows, strict=True):
        title, *lines = block.splitlines()
        assert title == f"fault:{kind} = {row['example']}"
        assert [line.split(maxsplit=1) for line in lines] == [
            [name, text] for name, text in row.items() if name not in ("kind", "example")
        ]


def _targets(rig: str, kind: str, *changes: str) -> list[str]:
    assigned = [(parse_assignment(change), as_written) for change in changes]
    return open_targets(fault_kinds()[kind], read_settings(*read_rig(RIGS / rig), assigned))


@pytest.mark.parametrize(
    ("kind", "targets"),
    [
        ("power_loss", ["X", "Y", "Z"]),  # of any drive
        ("reset", ["X", "Y"]),  # there is no NMT on EtherCAT
        ("bus_off", ["X", "Y"]),
        ("babble", ["can1", "can2"]),
        ("sync_jitter", ["can1", "can2"]),
        ("sync_loss", ["can1", "can2", "X", "Y"]),
        ("line_lost", ["ec1"]),
        ("slave_falls", ["Z"]),
        ("clock_jump", ["Z"]),
        ("soe_silent", []),
        ("image_lost", []),
        ("crossed", ["X", "Y", "Z"]),  # wires are anywhere
        ("probe_stick", ["probe"]),
        ("plc_lost", []),
    ],
)
def test_a_kind_is_open_for_targets_on_a_carrier_that_has_it(kind: str, targets: list[str]) -> None:
    """X and Y are on CAN, Z is on a line."""
    assert sorted(_targets("probe-xyz-mixed.toml", kind)) == sorted(targets)
    telegrams = _targets("probe-xyz-mixed.toml", "drop")
    assert {name.partition(".")[0] for name in telegrams} == {"X", "Y", "can1", "can2"}


@pytest.mark.parametrize(
    ("rig", "kind", "targets"),
    [
        ("probe-z-profidrive.toml", "image_lost", ["Z"]),
        ("probe-z-profidrive.toml", "life_stuck", ["Z"]),
        ("probe-z-lightbus.toml", "life_stuck", []),  # it has no such interface
        ("probe-z-lightbus.toml", "image_late", ["Z"]),
        ("probe-z-profidrive.toml", "power_loss", ["Z"]),
        ("probe-z-profidrive.toml", "slave_falls", []),
        ("probe-z-sercos.toml", "bit_stuck", ["Z"]),
        ("probe-z-sercos.toml", "line_corrupt", ["Z"]),
        ("probe-z-sercos.toml", "reset", []),
    ],
)
def test_a_kind_is_open_for_the_drives_that_have_what_it_is_about(
    rig: str, kind: str, targets: list[str]
) -> None:
    assert _targets(rig, kind) == targets


def test_heartbeats_are_lost_of_drives_that_send_them() -> None:
    change = "drive:servo.heartbeat_ms=20"
    assert _targets("probe-xyz.toml", "heartbeat_loss") == []
    assert _targets("probe-xyz.toml", "heartbeat_loss", change) == ["X", "Y", "Z"]


@pytest.mark.parametrize(
    ("rig", "fault", "target", "allowed", "hint"),
    [
        ("probe-xyz-mixed.toml", "drop", "Z.TPDO1", "can1, can2", "on ec1 there are "),
        ("probe-xyz-mixed.toml", "babble", "ec1", "can1, can2", "on ec1 there are "),
        ("probe-z-ethercat.toml", "reset", "Z", "none", "on ec1 there are "),
        ("probe-z-profidrive.toml", "reset", "Z", "none", "on bus there are "),
    ],
)
def test_a_refused_fault_names_its_target_and_the_segments_that_have_it(
    rig: str, fault: str, target: str, allowed: str, hint: str
) -> None:
    change = f"fault:{fault}={target}"
    with pytest.raises(UserError) as caught:
        check_rig(read_settings(*read_rig(RIGS / rig), [(parse_assignment(change), as_written)]))
    error = caught.value
    assert error.allowed == allowed
    kinds = str(error.hint).partition(hint)[2].partition(";")[0].split(", ")
    rooms = ("lines", "drives", "idents") if " ec1 " in hint else ("images", "drives")
    assert kinds == [kind.name for kind in fault_kinds().values() if kind.room in rooms]
    assert error.message.startswith(f"--set {change}: ")
    assert error.value == target
