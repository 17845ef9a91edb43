"""What may stand in a column `fault:<kind>`, and the message about what may not."""

import re
from contextlib import nullcontext
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.faults import (
    Fault,
    Moment,
    fault_keys,
    fault_kinds,
    fault_moments,
    faults_table,
    needs_heartbeats,
    read_faults,
    read_time,
)
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
MS = 1_000_000


@pytest.fixture(scope="module")
def rig() -> RigFile:
    """Axes X, Y and Z on the buses can1, can2 and can3."""
    return read_rig(RIGS / "probe-xyz.toml")[0]


def one(rig: RigFile, kind: str, text: str) -> Fault:
    (fault,) = read_faults(kind, text, rig)
    return fault


def test_a_telegram_alone_is_every_frame_of_it_for_the_whole_run(rig: RigFile) -> None:
    fault = one(rig, "drop", "Z.TPDO2")
    assert (fault.kind, fault.axis, fault.telegram) == ("drop", "Z", "TPDO2")
    assert fault.values == {
        "p": 1.0, "count": None, "skip": 0, "at": None, "for": None, "nth": 1
    }  # fmt: skip


def test_a_probability_a_number_of_frames_and_a_window_in_time(rig: RigFile) -> None:
    values = one(rig, "drop", "Z.TPDO1 p=0.02 at=1.2s for=250us count=5 skip=3").values
    assert values["p"] == 0.02
    assert values["at"] == Moment("start", 1200 * MS)
    assert (values["for"], values["count"], values["skip"]) == (250_000, 5, 3)


def test_a_moment_of_the_run_with_an_offset(rig: RigFile) -> None:
    assert one(rig, "reset", "X at=motion").values["at"] == Moment("motion", 0)
    assert one(rig, "reset", "X at=edge+1.5ms").values["at"] == Moment("edge", 1_500_000)
    assert one(rig, "reset", "X at=0s").values["at"] == Moment("start", 0)


def test_times_are_read_in_whole_nanoseconds(rig: RigFile) -> None:
    """0.3 ms as a float times a million is 299999.99999999994."""
    assert one(rig, "delay", "X.TPDO1 by=0.3ms").values["by"] == 300_000
    assert one(rig, "delay", "X.TPDO1 by=1.000000001s").values["by"] == 1_000_000_001
    assert one(rig, "delay", "X.TPDO1 by=1500ns").values["by"] == 1500
    units = {"ns": 1, "us": 1000, "ms": MS, "s": 1000 * MS}
    for unit, unit_ns in units.items():
        assert read_time(f"007{unit}") == read_time(f"7.{unit}") == 7 * unit_ns
        assert read_time(f".5{unit}") == unit_ns // 2
        for part in range(0, 1000 if unit_ns > 1 else 1, 7):
            assert read_time(f"1.{part:03}{unit}") == unit_ns + part * unit_ns // 1000
    for text in ("5", "ms", "-1ms", "1 ms", "1,5ms", "1e3ms", "1_0ms", ".ms", "1min", "1MS"):
        with pytest.raises(ValueError, match=re.escape(text)):
            read_time(text)


def test_several_targets_share_their_keys_and_semicolons_part_faults(rig: RigFile) -> None:
    faults = read_faults("drop", "Z.TPDO1 X.TPDO1 p=0.5; can1.SYNC count=1", rig)
    assert [(f.target, f.values["p"], f.values["count"]) for f in faults] == [
        ("Z.TPDO1", 0.5, None), ("X.TPDO1", 0.5, None), ("can1.SYNC", 1.0, 1)
    ]  # fmt: skip


def test_a_sync_can_be_lost_for_a_bus_or_for_one_drive(rig: RigFile) -> None:
    assert one(rig, "sync_loss", "can1").segment == "can1"
    assert one(rig, "sync_loss", "Z").axis == "Z"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("00ff10", b"\x00\xff\x10"),
        ("0011223344556677", bytes.fromhex("0011223344556677")),  # as much as a frame carries
        ("random", "random"),
        ("", None),
    ],
)
def test_data_of_a_second_sender(rig: RigFile, text: str, expected: object) -> None:
    if expected is None:
        assert one(rig, "second_sender", "Z.TPDO1").values["data"] == "last"
    else:
        assert one(rig, "second_sender", f"Z.TPDO1 data={text}").values["data"] == expected


@pytest.mark.parametrize(
    ("kind", "text", "found", "allowed"),
    [
        ("dorp", "Z.TPDO1", "dorp", "drop"),
        ("drop", "Z.TPDO7", "Z.TPDO7", "Z.TPDO1, Z.TPDO2"),
        ("drop", "W.TPDO1", "W.TPDO1", "X.TPDO1"),
        ("drop", "p=0.1", "p=0.1", "X.TPDO1"),
        ("drop", "Z.TPDO1;", "Z.TPDO1;", ""),
        ("drop", "Z.TPDO1 by=1ms", "by", "p, count, skip, at, for, nth"),
        ("drop", "Z.TPDO1 p=2", "2", "0 to 1"),
        ("drop", "Z.TPDO1 p=nan", "nan", "0 to 1"),
        ("drop", "Z.TPDO1 p=", "", "0 to 1"),
        ("drop", "Z.TPDO1 p=0.1 p=0.2", "p=0.2", ""),
        ("drop", "Z.TPDO1 count=0", "0", "1 to 1000000"),
        ("drop", "Z.TPDO1 count=1.5", "1.5", "1 to 1000000"),
        ("drop", "Z.TPDO1 at=tomorrow", "tomorrow", "latched"),
        ("drop", "Z.TPDO1 at=motion+5", "motion+5", "motion+2ms"),
        ("drop", "Z.TPDO1 at=-1ms", "-1ms", "a time after the start"),
        ("drop", "Z.TPDO1 for=0s", "0s", "1us to 600s"),
        ("delay", "Z.TPDO1 by=3", "3", "1us to 60s"),
        ("delay", "Z.TPDO1 by=٣ms", "٣ms", "1us to 60s"),
        ("second_sender", "Z.TPDO1 data=0x12", "0x12", "hexadecimal"),
        ("second_sender", "Z.TPDO1 data=001122334455667788", "0011", "hexadecimal"),
        ("reset", "Z command=halt", "halt", "reset reset_communication stop"),
        ("babble", "Z", "Z", "can1, can2"),
        ("babble", "can1 id=0x800", "0x800", "0 to 0x7FF"),
    ],
)
def test_what_cannot_be_is_told_with_what_can(
    rig: RigFile, kind: str, text: str, found: str, allowed: str
) -> None:
    with pytest.raises(UserError) as error:
        read_faults(kind, text, rig)
    assert found in str(error.value.value)
    assert allowed in str(error.value)


def test_every_kind_has_keys_that_are_declared_and_every_key_a_kind() -> None:
    used = {key for kind in fault_kinds().values() for key in kind.keys}
    assert used == set(fault_keys())


def test_the_listing_names_every_kind_key_and_moment() -> None:
    words = set(re.findall(r"\w+", faults_table()))
    assert words >= {*fault_kinds(), *fault_keys(), *fault_moments()}


def test_the_listing_of_one_kind_tells_the_reactions() -> None:
    text = faults_table("second_sender")
    assert "fault:second_sender = Z.TPDO1" in text
    assert "900080" in text
    with pytest.raises(UserError, match="unknown kind"):
        faults_table("second_sende")


def test_no_kind_of_fault_does_nothing_by_default(rig: RigFile) -> None:
    assert one(rig, "sync_jitter", "can1").values["jitter"] == 100_000
    assert one(rig, "power_loss", "Z").values["for"] == 100 * MS
    with pytest.raises(UserError, match=r"sync_jitter does nothing.*100us without it"):
        one(rig, "sync_jitter", "can1 jitter=0us")
    for kind, key in (("delay", "by"), ("slow_sdo", "by")):
        target = "Z" if kind == "slow_sdo" else "Z.TPDO1"
        assert one(rig, kind, target).values[key] > 0


def test_heartbeats_that_nobody_sends_cannot_be_lost() -> None:
    def read(*texts: str) -> None:
        read_settings(
            *read_rig(RIGS / "probe-z.toml"),
            [(parse_assignment(text), as_written) for text in texts],
        )

    with pytest.raises(UserError, match=r"--set fault:heartbeat_loss=Z: drive servo sends no"):
        read("fault:heartbeat_loss=Z")
    read("fault:heartbeat_loss=Z", "drive:servo.heartbeat_ms=20")
    # The answers of a guarded node are lost as heartbeats are
    read("fault:heartbeat_loss=Z", "drive:servo.guard_time_ms=20")
    rig, _ = read_rig(RIGS / "probe-z.toml")
    faults = read_faults("heartbeat_loss", "Z", rig)
    for writes, is_sent in (([["0x1017:0", 20]], True), ([["0x1018:0", 20]], False)):
        drive = rig.drive["servo"].model_copy(update={"sdo": writes})
        written = rig.model_copy(update={"drive": {**rig.drive, "servo": drive}})
        with nullcontext() if is_sent else pytest.raises(UserError, match="sends no heartbeats"):
            needs_heartbeats(faults, written)


@pytest.mark.parametrize("axis", ["X", "X2"])
def test_only_telegrams_of_the_same_axis_are_offered_for_a_wrong_one(axis: str) -> None:
    """The name of one axis begins with that of the other."""
    gantry = read_rig(RIGS / "fixed-stop-gantry.toml")[0]
    assert {"X", "X2"} <= {*gantry.axis}
    with pytest.raises(UserError, match="no such telegram") as caught:
        read_faults("drop", f"{axis}.TPDO99", gantry)
    allowed = re.findall(r"\w+\.\w+", str(caught.value).partition("allowed")[2])
    assert f"{axis}.TPDO1" in allowed
    assert {name.partition(".")[0] for name in allowed} == {axis}
