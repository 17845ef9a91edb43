"""Rigs with segments, lists and keys of several kinds: each has its own, and errors name it."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.cnc_objects import objects_table
from axisrig.bench.rig.contents import contents_text
from axisrig.bench.rig.loop import check_gain
from axisrig.bench.rig.parameter_words import warning
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.distance.objects import channel_objects
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.table import Correction

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def mixed(*assignments: str, is_turned: bool = False) -> Settings:
    """Read a rig with can1, can2 and the line ec1; is_turned: in the other order."""
    rig, files = read_rig(RIGS / "probe-xyz-mixed.toml")
    if is_turned:
        rig = rig.model_copy(update={"segment": dict(reversed(rig.segment.items()))})
    return read_settings(rig, files, [(parse_assignment(text), as_written) for text in assignments])


@pytest.mark.parametrize("is_turned", [False, True])
def test_all_segments_are_those_that_have_the_key(is_turned: bool) -> None:
    """Whichever comes first in the rig: a line has no bit rate, a bus no wire."""
    before = mixed(is_turned=is_turned).segment
    segments: Any = mixed("bus:all.bitrate=250000", is_turned=is_turned).segment
    assert [segments[name].bitrate for name in ("can1", "can2")] == [250_000] * 2
    assert segments["ec1"] == before["ec1"]
    segments = mixed("bus:all.wire_ns=123", is_turned=is_turned).segment
    assert segments["ec1"].wire_ns == 123
    assert [segments[name] for name in ("can1", "can2")] == [before["can1"], before["can2"]]


@pytest.mark.parametrize("is_turned", [False, True])
def test_a_key_that_no_segment_has_is_refused_with_those_of_each_kind(is_turned: bool) -> None:
    with pytest.raises(UserError, match="a segment has no such key") as caught:
        mixed("bus:all.xyzzy=1", is_turned=is_turned)
    allowed = (caught.value.allowed or "").split(", ")
    assert {"bitrate", "queue", "wire_ns"} <= {*allowed}
    assert len({*allowed}) == len(allowed)
    with pytest.raises(UserError) as caught:
        mixed("bus:ec1.xyzzy=1", is_turned=is_turned)
    assert "bitrate" not in (caught.value.allowed or "")


def test_a_file_of_a_drive_that_is_not_there_is_shown_what_is_near(
    rig_file: Write, settings_of: Read, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "servo.eds").write_text("")
    monkeypatch.chdir(tmp_path)
    path = rig_file()
    with pytest.raises(UserError, match="eds names no file") as e:
        settings_of(path, "drive:servo.eds=sevro.eds")
    assert (e.value.value, e.value.hint) == ("sevro.eds", "near it: servo.eds")


ANOTHER = """[axis.X]
list = "lists/axis-x.lst"
segment = "can1"
node = 4
drive = "servo"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"

[axis.Z]
"""
PAST = "getriebe[0].lslope_profil.a_stufe_1 900\ngetriebe[0].dynamik.a_max 500\n"


@pytest.mark.parametrize("axes", ["", "X", "Z", "XZ"])
def test_what_goes_past_another_parameter_is_noted_for_each_axis(
    rig_file: Write, settings_of: Read, axes: str
) -> None:
    path = rig_file(("[axis.Z]\n", ANOTHER))
    for axis in axes:
        file = path.parent / "lists" / f"axis-{axis.lower()}.lst"
        file.write_text(file.read_text(encoding="utf-8") + PAST, encoding="utf-8")
    notes = [note for note in settings_of(path).notes if "(P-AXIS-00011) = 900 mm/s2" in note]
    assert [note.partition(":")[0] for note in notes] == [f"axis {axis}" for axis in axes]


def test_a_list_of_two_axes_says_of_each_what_is_corrected(tmp_path: Path) -> None:
    """The measuring feed is above the speed of the axis in the second and in both of them."""
    path = tmp_path / "axes.lst"
    good = "kopf.achs_nr {0}\nkopf.log_achs_name {1}\n"
    fast = "kenngr.vb_messen 300000\ngetriebe[0].dynamik.vb_max 200000\n"
    for first, second, named in ((0, 1, ["B"]), (1, 1, ["A", "B"]), (1, 0, ["A"])):
        path.write_text(
            good.format(1, "A") + fast * first + good.format(2, "B") + fast * second,
            encoding="utf-8",
        )
        lines = contents_text(path).splitlines()
        warnings = [line for line in lines if line.startswith("warning: ID 900522")]
        assert len(warnings) == len(named)
        assert all(f" {name}" in line for name, line in zip(named, warnings, strict=True))


def refused(path: Path) -> UserError:
    with pytest.raises(UserError) as caught:
        read_rig(path)
    return caught.value


def test_a_misspelt_key_of_a_table_with_many_is_shown_the_one_that_was_meant(
    rig_file: Write,
) -> None:
    """Keys of a short table are all shown beside it, and where none is near all of them are."""
    error = refused(rig_file(("lead_mm = 10.0", "lead_mm = 10.0\nheartbeat_mss = 20")))
    assert (error.allowed, error.hint) == (None, "did you mean heartbeat_ms?")
    error = refused(rig_file(("[cycle]\n", "[cycle]\nsync_countr = 0\n")))
    assert error.hint == "did you mean sync_counter?"
    assert {"period_us", "cycle_offset_us", "sync_counter"} <= {*(error.allowed or "").split(", ")}
    error = refused(rig_file(("lead_mm = 10.0", "lead_mm = 10.0\nxyzzy = 20")))
    assert error.hint is None
    assert {"heartbeat_ms", "lead_mm"} <= {*(error.allowed or "").split(", ")}


def test_a_warning_that_corrects_nothing_has_both_its_numbers() -> None:
    row: Any = SimpleNamespace(correction=Correction(110001, older_id=7, is_kept=True))
    assert warning(row) == "110001 (7 in the older structure), not corrected"


@pytest.mark.parametrize(("kv", "is_refused"), [(25_599, False), (25_600, True), (25_601, True)])
def test_a_gain_at_its_limit_is_refused(
    rig_file: Write, settings_of: Read, kv: int, is_refused: bool
) -> None:
    """Kv T below 0.5 with T = 1/512 s, which a double has: so below 256 1/s."""
    settings = settings_of(rig_file(), f"set:Z.getriebe[0].kv={kv}")
    what = settings, "Z", 0.5, 1.0, 1 / 512, "CNC", "lower it"
    if not is_refused:
        check_gain(*what)
        return
    with pytest.raises(UserError, match=r"Kv T is 0\.5 and must be below 0\.5") as caught:
        check_gain(*what)
    assert (caught.value.value, caught.value.allowed) == (kv, "below 25600 0.01/s")


def test_objects_of_each_axis_say_so() -> None:
    lines = objects_table().splitlines()
    for number, row in enumerate(channel_objects().values(), 1):
        (line,) = [text for text in lines if text.startswith(f"{number}  {row.name}  ")]
        assert ("of each axis" in line.split("  ")) is row.of_axis
    assert len({row.of_axis for row in channel_objects().values()}) == 2
