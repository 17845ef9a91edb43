"""The parameter lists of a rig: shared by axes, what does not act yet, corrections at the start."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.campaign.checking import check_file
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.lists import drive_input, substituted, substituted_in_words
from axisrig.bench.rig.settings import AS_CANOPEN, Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"

SECOND_AXIS = """\
[axis.X]
list = "lists/axis-z.lst"
segment = "can1"
node = 4
drive = "servo"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"

[plant.probe]"""
MACHINE = "kopf.achs_nr 1\nkopf.log_achs_name X\ngetriebe[0].window 7\n" \
    "kopf.achs_nr 3\nkopf.log_achs_name Z\ngetriebe[0].window 9\n"  # fmt: skip


def listed(rig: Path, text: str, name: str = "axis-z.lst") -> Path:
    (rig.parent / "lists" / name).write_text(text, encoding="utf-8")
    return rig


def test_axes_share_a_list_and_each_takes_its_part(rig_file: Write, settings_of: Read) -> None:
    late = ("cycle_offset_us = 600", "cycle_offset_us = 620")  # room for a second drive
    rig = listed(rig_file(late, ("[plant.probe]", SECOND_AXIS)), MACHINE)
    settings = settings_of(rig)
    assert settings.axis["X"].integer("getriebe[0].window") == 7
    assert settings.axis["Z"].integer("getriebe[0].window") == 9
    check_rig(settings)


def test_an_axis_that_a_shared_list_does_not_have(rig_file: Write, settings_of: Read) -> None:
    rig = listed(rig_file(), MACHINE.replace("name Z", "name W"))
    with pytest.raises(UserError, match=r"none of them is Z; allowed: X, W"):
        settings_of(rig)


def test_two_axes_with_one_number_are_refused(rig_file: Write, settings_of: Read) -> None:
    rig = rig_file(("[plant.probe]", SECOND_AXIS.replace("axis-z.lst", "axis-x.lst")))
    listed(listed(rig, "kopf.achs_nr 2\n", "axis-x.lst"), "kenngr.messachse 1\nkopf.achs_nr 2\n")
    with pytest.raises(UserError, match="axes Z and X have the same logical number") as caught:
        check_rig(settings_of(rig))
    assert (Path(str(caught.value.file)).name, caught.value.line) == ("axis-x.lst", 1)


def test_check_tells_a_list_too(tmp_path: Path) -> None:
    path = tmp_path / "z.lst"
    path.write_text("kenngr.distc.kp 5\ngetriebe[0].window 30\n", encoding="utf-8")
    text = check_file(path)
    assert "getriebe[0].window" in text
    assert "30 x 0.1 um = 0.003 mm" in text
    assert "warning: ID 315010 class 1: " in text
    path.write_text("kenngr.dist kp 5\n", encoding="utf-8")
    with pytest.raises(UserError, match="unknown axis parameter"):
        check_file(path)


def test_check_tells_a_list_of_zero_offsets_or_tools_as_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "some.lst"
    path.write_text("# zero\nnp_grp[1].achse[2].versch 330000\n", encoding="utf-8")
    text = check_file(path)
    assert "zero offsets" in text
    assert "np_grp[1].achse[2].versch 330000 x 0.1 um = 33 mm  some.lst:2" in text
    path.write_text("wz[1].radius 20000\nwz[1].gueltig 1\n", encoding="utf-8")
    assert "wz[1].radius 20000 x 0.1 um = 2 mm" in check_file(path)
    path.write_text("wz[1].lenght 5\n", encoding="utf-8")
    with pytest.raises(UserError, match="unknown name in a list of tools"):
        check_file(path)


def test_values_of_offset_lists_that_cannot_be_meant_are_notes(
    rig_file: Write, settings_of: Read
) -> None:
    named = 'list = "lists/channel.lst"\nzero_offsets = "lists/z0.lst"\ntools = "lists/t.lst"'
    rig = rig_file(('list = "lists/channel.lst"', named))
    listed(rig, "np_grp[1].achse[0].versch 1\nnp_grp[1].achse[9].versch 2\n", "z0.lst")
    tools = "wz[1].radius -20000\nwz[1].gueltig 1\nwz[1].laenge -5\nwz[3].laenge 7\n"
    listed(rig, tools, "t.lst")
    far, radius, useless = settings_of(rig).notes
    assert far == (
        "zero offsets: np_grp[1].achse[9].versch 2 (z0.lst:2): the rig has no axis 9, it has 0 = Z"
    )
    assert radius == "tools: wz[1].radius -20000 (t.lst:1): a radius below 0"
    assert "wz[3].laenge 7 (t.lst:4): the list has no `wz[3].gueltig 1`" in useless
    later = settings_of(rig, "set:tools.wz[3].gueltig=1", "set:tools.wz[1].radius=1")
    assert later.notes == [far], "a cell counts, not what it replaces"


def test_a_file_that_check_does_not_know_names_what_does(tmp_path: Path) -> None:
    program = tmp_path / "p.nc"
    program.write_text("M30\n", encoding="utf-8")
    with pytest.raises(UserError, match=r"axisrig nc --check .*p\.nc"):
        check_file(program)
    with pytest.raises(
        UserError, match=r"a folder.*\.csv, \.xlsx, \.ods, \.parquet, \.toml, \.lst, \.lis"
    ):
        check_file(tmp_path)


def test_what_does_not_act_is_told_once_for_each_list(rig_file: Write, settings_of: Read) -> None:
    inert = "antr.sercos.mdt_offset 300\nantr.sercos.eval_calc_slot 1\n"
    rig = listed(rig_file(), f"{inert}kenngr.messachse 1\n")
    listed(
        rig, "kasto_prog_meas_trigger 1\nconfiguration.decoder.max_cache_size 10\n", "channel.lst"
    )
    channel, axis = settings_of(rig).notes
    assert channel == (
        "channel: 2 settings do not act yet (channel.lst):"
        " kasto_prog_meas_trigger = 1, configuration.decoder.max_cache_size = 10"
    )
    assert axis == (
        "axis Z: 2 settings do not act yet (axis-z.lst):"
        " antr.sercos.mdt_offset = 300, antr.sercos.eval_calc_slot = 1"
    )


def test_a_list_in_which_all_acts_is_not_told_of(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(listed(rig_file(), "kenngr.messachse 1\nkenngr.distc.kp 0.5\n"))
    assert (settings.notes, settings.warnings) == ([], [])


def test_a_cell_that_sets_the_default_takes_the_note_away(
    rig_file: Write, settings_of: Read
) -> None:
    rig = listed(rig_file(), "antr.sercos.mdt_offset 300\n")
    assert settings_of(rig, "set:Z.antr.sercos.mdt_offset=0").notes == []


@pytest.mark.provokes(315010, 1, owner="axis Z", value=5.0, corrected=2.0)
def test_a_correction_is_a_warning_of_the_rig(rig_file: Write, settings_of: Read) -> None:
    settings = settings_of(listed(rig_file(), "kenngr.distc.kp 5\n"))
    assert [warning.id for warning in settings.warnings] == [315010]
    assert settings.axis["Z"].get("kenngr.dist_ctrl[0].kp") == 2.0


def test_check_tells_warnings_and_notes(rig_file: Write) -> None:
    text = check_file(listed(rig_file(), "kenngr.distc.kp 5\nantr.sercos.mdt_offset 300\n"))
    assert "warning: ID 315010 class 1: " in text
    assert "(axis-z.lst:1)" in text
    assert "note: axis Z: 1 setting does not act yet (axis-z.lst): antr.sercos.mdt_offset" in text


@pytest.mark.parametrize(("number", "used"), [("1", 1), ("2", 2), ("4", 1), ("255", 1)])
def test_an_input_of_external_hardware_is_none_of_the_drive(
    rig_file: Write, settings_of: Read, number: str, used: int
) -> None:
    text = f"kenngr.measure.signal PLC_EXT_LATCH_CONTROL\nkenngr.measure.input {number}\n"
    settings = settings_of(listed(rig_file(), text))
    assert drive_input(settings.axis["Z"]) == used
    check_rig(settings)


SERCOS = "kopf.log_achs_name Z\nkenngr.antr_typ 2\n"


def test_a_drive_type_that_is_not_simulated_is_refused(rig_file: Write, settings_of: Read) -> None:
    """In the list with file and line, in a cell with its place; 8 and nothing said are CANopen."""
    rig = listed(rig_file(), SERCOS)
    with pytest.raises(UserError, match=r"axis Z .* SERCOS \(2\).*family canopen") as caught:
        check_rig(settings_of(rig))
    assert (Path(str(caught.value.file)).name, caught.value.line) == ("axis-z.lst", 2)
    assert "--as-canopen" in str(caught.value)
    with pytest.raises(UserError, match=r"kenngr.antr_typ.*does not act"):
        settings_of(rig, "set:Z.kenngr.antr_typ=5")
    canopen = settings_of(rig, "set:Z.kenngr.antr_typ=8")
    check_rig(canopen)
    assert substituted(canopen.rig, canopen.axis) == {}


@pytest.mark.parametrize("key", [AS_CANOPEN, "drive:servo.as_canopen=true"])
def test_a_drive_may_stand_for_one_of_another_type(
    rig_file: Write, settings_of: Read, key: str
) -> None:
    settings = settings_of(listed(rig_file(), SERCOS), key)
    check_rig(settings)
    assert substituted(settings.rig, settings.axis) == {"Z": "SERCOS (2)"}


@pytest.mark.parametrize(
    "rig", ["probe-z", "probe-z-sercos", "probe-z-profidrive", "probe-z-lightbus",
            "probe-z-conventional", "probe-z-encoder-terminal", "probe-xyz-mixed"],
)  # fmt: skip
@pytest.mark.parametrize("says", [True, False])
def test_a_drive_of_the_rig_replaces_none_where_the_list_names_it_or_none(
    tmp_path: Path, settings_of: Read, rig: str, says: bool
) -> None:
    """P-AXIS-00020 as the shipped lists have it, and lists that say nothing of a drive."""
    path = RIGS / f"{rig}.toml"
    if not says:
        axes = settings_of(path).rig.axis
        text = f'base = "{path.as_posix()}"\n'
        for name, axis in axes.items():
            words = Path(axis.list).read_text(encoding="utf-8").splitlines()
            kept = [word for word in words if not word.startswith("kenngr.antr_typ")]
            (tmp_path / f"{name}.lst").write_text("\n".join([*kept, ""]), encoding="utf-8")
            text += f'[axis.{name}]\nlist = "{name}.lst"\n'
        path = tmp_path / "own.toml"
        path.write_text(text, encoding="utf-8")
    settings = settings_of(path)
    assert substituted(settings.rig, settings.axis) == {}
    assert substituted_in_words(settings.rig, settings.axis) == ""


def test_every_drive_is_meant_by_all(rig_file: Write, settings_of: Read) -> None:
    drives = settings_of(rig_file(), "drive:all.lead_mm=5").rig.drive
    assert {drive.lead_mm for drive in drives.values()} == {5.0}
    with pytest.raises(UserError, match=r"no such drive.*servo, all"):
        settings_of(rig_file(), "drive:sevro.lead_mm=5")


DETECT = "kenngr.measure.fixed_stop_detect."
STOP = "kenngr.measure.signal FIXED_STOP\n"
LAG = f"{DETECT}pos_lag_limit 15000\n"
FALLBACK = "antr.fixed_stop.detect."
NEVER = "axis Z: as listed no stop can be found"
NO_TIME = f"{NEVER}, its window of 0.02 mm has no minimum time: set min_time"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (STOP + LAG, None),
        (STOP, f"{NEVER}: set a lag limit (P-AXIS-00774 pos_lag_limit) or a window"),
        ("kenngr.meas_signal_fixed_stop 1\nkenngr.achs_typ 0x0001\n", f"{NEVER}: set a lag limit"),
        (f"{STOP}{DETECT}pos_lag_limit 0\n{FALLBACK}pos_lag_limit 15000\n", f"{NEVER}: set"),
        (f"{STOP}{FALLBACK}pos_lag_limit 15000\n", None),
        (f"{STOP}{DETECT}max_delta_position_window 200\n", NO_TIME),
        (f"{STOP}{DETECT}max_delta_position_window 200\nkenngr.fixed_stop_nbr_cycles 3\n", None),
        (DETECT + "pos_lag_limit 0\n", None),  # no runs to a stop
        (
            f"{STOP}{LAG}{FALLBACK}start_distance 20000\n",
            f"axis Z: {FALLBACK}start_distance (P-AXIS-00771) does not act:"
            f" {DETECT}start_distance (P-AXIS-00776) is asked first and its default is 0",
        ),
        (f"{STOP}{LAG}{FALLBACK}start_distance 1\n{DETECT}start_distance -1\n", None),
        (f"{STOP}{LAG}{FALLBACK}start_distance 1\n{DETECT}start_distance 0\n", None),
        (f"{STOP}{LAG}{FALLBACK}start_distance_per_mille 100\n", None),
    ],
)
def test_lists_that_find_no_stop_or_set_what_nobody_asks(
    rig_file: Write, settings_of: Read, text: str, message: str | None
) -> None:
    notes = settings_of(listed(rig_file(), text)).notes
    about = [note for note in notes if "stop" in note or "does not act:" in note]
    assert (about[0].startswith(message) and len(about) == 1) if message else about == []
