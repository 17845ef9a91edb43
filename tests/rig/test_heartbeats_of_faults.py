"""Heartbeats that a fault loses are those of the run: of the rig as its assignments leave it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
LOST = "fault:heartbeat_loss=Z"
REFUSED = r"drive servo sends no heartbeats that could be lost"
SENDS = ("lead_mm = 10.0", "lead_mm = 10.0\nheartbeat_ms = 50")
GUARDED = ("lead_mm = 10.0", "lead_mm = 10.0\nguard_time_ms = 50")
WRITES = ("lead_mm = 10.0", 'lead_mm = 10.0\nsdo = [["0x1017:0", 50]]')


@pytest.mark.parametrize("key", ["heartbeat_ms=20", "guard_time_ms=20"])
@pytest.mark.parametrize("target", ["servo", "all"])
@pytest.mark.parametrize("is_first", [True, False])
def test_an_assignment_that_switches_them_on_lets_them_be_lost(
    rig_file: Write, settings_of: Read, key: str, target: str, is_first: bool
) -> None:
    """Before the fault or behind it, for the drive or for all."""
    on = f"drive:{target}.{key}"
    found = settings_of(rig_file(), *((on, LOST) if is_first else (LOST, on)))
    (fault,) = found.faults
    assert (fault.kind, fault.axis) == ("heartbeat_loss", "Z")
    assert found.rig.drive["servo"].shows_life
    assert not found.written.drive["servo"].shows_life


SECOND = (WRITES[0], WRITES[1].replace("[[", '[["0x6065:0", 5], ["0x1018:0", 1], ['))
OTHERS = (WRITES[0], WRITES[1].replace("0x1017:0", "0x1016:1"))


def test_a_write_of_another_object_sends_no_heartbeats(rig_file: Write, settings_of: Read) -> None:
    """1016 is the watch of the drive over others, 1017 the time of its own (CiA 301)."""
    with pytest.raises(UserError, match=REFUSED):
        settings_of(rig_file(OTHERS), LOST)


@pytest.mark.parametrize("change", [SENDS, GUARDED, WRITES, SECOND])
def test_a_rig_that_has_them_lets_them_be_lost(
    rig_file: Write, settings_of: Read, change: tuple[str, str]
) -> None:
    assert len(settings_of(rig_file(change), LOST).faults) == 1


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize(
    ("change", "off"), [(SENDS, "heartbeat_ms=0"), (GUARDED, "guard_time_ms=0")]
)
def test_an_assignment_that_switches_them_off_leaves_none_to_lose(
    rig_file: Write, settings_of: Read, change: tuple[str, str], off: str, is_first: bool
) -> None:
    away = f"drive:servo.{off}"
    with pytest.raises(UserError, match=REFUSED) as caught:
        settings_of(rig_file(change), *((away, LOST) if is_first else (LOST, away)))
    assert caught.value.message.startswith(f"--set {LOST}: ")
    assert caught.value.value == "Z"
    assert caught.value.hint == "drive:servo.heartbeat_ms=20 lets it send them"


def test_the_last_of_two_assignments_decides(rig_file: Write, settings_of: Read) -> None:
    on, off = "drive:servo.heartbeat_ms=20", "drive:servo.heartbeat_ms=0"
    assert settings_of(rig_file(), off, LOST, on).faults
    with pytest.raises(UserError, match=REFUSED):
        settings_of(rig_file(), on, LOST, off)


def test_a_rig_without_them_says_which_drive_sends_none(rig_file: Write, settings_of: Read) -> None:
    with pytest.raises(UserError, match=REFUSED):
        settings_of(rig_file(), LOST)
    assert settings_of(rig_file(), "fault:drop=Z.TPDO1").faults  # needs none


TWO = """
[drive.other]
lead_mm = 5.0

[axis.X]
list = "lists/axis-x.lst"
segment = "can1"
node = 4
drive = "other"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"

[plant.z]
"""


@pytest.mark.parametrize(
    ("on", "lost", "wrong"),
    [
        ("servo", "Z", None), ("servo", "X", "other"), ("other", "X", None),
        ("other", "Z", "servo"), ("servo", "Z X", "other"), ("servo", "X; Z", "other"),
        ("all", "X Z", None),
    ],
)  # fmt: skip
def test_each_drive_has_its_own_heartbeats(
    rig_file: Write, settings_of: Read, on: str, lost: str, wrong: str | None
) -> None:
    """X has the drive other, Z the drive servo."""
    path = rig_file(("\n[plant.z]\n", TWO))
    words = (f"drive:{on}.heartbeat_ms=20", f"fault:heartbeat_loss={lost}")
    if wrong is None:
        assert len(settings_of(path, *words).faults) == len(lost.replace(";", "").split())
        return
    with pytest.raises(UserError, match=f"drive {wrong} sends no heartbeats") as caught:
        settings_of(path, *words)
    assert caught.value.value == ("X" if wrong == "other" else "Z")


@pytest.mark.parametrize("keys", ["", "[drive.servo]\nheartbeat_ms = 50"])
def test_a_drive_on_a_line_is_said_to_have_no_such_fault_and_not_to_lack_heartbeats(
    rig_above: Read, keys: str
) -> None:
    """There are none on EtherCAT, whatever the drive has."""
    with pytest.raises(
        UserError, match="there are no such faults of segments of the kind ethercat"
    ):
        check_rig(rig_above("probe-z-ethercat.toml", keys, LOST))
