"""`axisrig params`: list, explain, values of a rig, differences, the page of the documents."""

import csv
import io
from collections.abc import Callable
from pathlib import Path

import pytest

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]

ROOT = Path(__file__).parents[2]
RIG = str(ROOT / "testplans/rigs/probe-xyz.toml")
LISTS = ROOT / "testplans/rigs/lists"

# Every number that the manuals of measurement and distance control name
AXIS = (
    "00001 00002 00004 00005 00006 00008 00011 00012 00016 00018 00020 00024 00053 "
    "00060 00081 00086 00098 00099 00106 00112 00113 00114 00115 00116 00117 00118 "
    "00145 00146 00147 00148 00153 00191 00212 00215 00230 00257 00269 00280 00281 "
    "00282 00283 00295 00328 00330 00331 00332 00408 00413 00414 00415 00416 00417 "
    "00418 00419 00420 00421 00422 00423 00424 00428 00430 00467 00487 00500 00501 "
    "00502 00504 00505 00506 00507 00508 00509 00516 00517 00518 00533 00534 00539 "
    "00583 00675 00677 00680 00702 00759 00764 00765 00769 00770 00771 00772 00773 "
    "00774 00775 00776 00777 00778 00782 00783 00784 00835 00852"
)
CHANNEL = (
    "00057 00097 00153 00176 00214 00257 00262 00266 00296 00311 00400 00500 00502 "
    "00503 00507 00508 00800 00801 00802 00803 00804 00805 00806 00807 00808 00809 "
    "00810 00811 00812 00813 00814 00815 00816 00817 00818 00819 00820 00821 00822 "
    "00823 00825 00826 00827 00829"
)


def said(axisrig: Call, *words: str, code: int = 0) -> str:
    found, out, err = axisrig("params", *words)
    assert (found, err) == (code, ""), err
    return out


def test_the_list_has_every_parameter_of_the_facts(axisrig: Call) -> None:
    listed = said(axisrig)
    wanted = [f"P-AXIS-{n}" for n in AXIS.split()] + [f"P-CHAN-{n}" for n in CHANNEL.split()]
    wanted.append("P-STUP-00050")
    assert [number for number in wanted if f"{number} " not in listed] == []


@pytest.mark.parametrize(
    "name",
    ["P-AXIS-00774", "p-axis-00774", "00774", "kenngr.measure.fixed_stop_detect.pos_lag_limit"],
)
def test_one_parameter_is_explained(axisrig: Call, name: str) -> None:
    text = said(axisrig, name)
    assert "SGN32 0.1 um (rotary axis: 0.0001 deg); 10000 are 1 mm" in text
    assert "default      -1" in text
    assert "negative: antr.fixed_stop.detect.pos_lag_limit (P-AXIS-00769), then" in text
    assert "kenngr.fixed_stop_pos_lag_limit (P-AXIS-00331)" in text
    assert "acts         yes" in text
    assert "FCT-C4 8.2.2" in text


def test_a_parameter_that_does_nothing_yet_says_so(axisrig: Call) -> None:
    assert "acts         no" in said(axisrig, "P-AXIS-00129")


@pytest.mark.parametrize("older", ["kenngr.distc.max_abweichung", "kenngr.distc.max_deviation"])
def test_an_older_name_leads_to_the_present_one(axisrig: Call, older: str) -> None:
    assert said(axisrig, older).startswith("P-AXIS-00414  kenngr.dist_ctrl[i].max_deviation\n")


def test_a_warning_is_explained(axisrig: Call) -> None:
    assert "315000 (110604 in the older structure), corrected" in said(axisrig, "P-AXIS-00415")
    assert "110757, not corrected" in said(axisrig, "P-AXIS-00777")
    assert "315010, corrected to 0.001 or the upper limit" in said(axisrig, "P-CHAN-00821")


def test_words_filter_the_list(axisrig: Call) -> None:
    lines = said(axisrig, "lag", "must", "exceeded").splitlines()[1:]
    assert [line.split()[0] for line in lines] == ["P-AXIS-00774"]


def test_the_csv_form_is_a_table(axisrig: Call) -> None:
    rows = list(csv.DictReader(io.StringIO(said(axisrig, "--format", "csv", "distance_axis"))))
    (row,) = (row for row in rows if row["number"] == "P-AXIS-00415")
    assert (row["unit"], row["rotary_unit"], row["default"]) == ("um/s", "0.001 deg/s", "5000")


def test_the_page_of_the_documents_is_fresh(axisrig: Call) -> None:
    page = (ROOT / "docs/parameters.md").read_text(encoding="utf-8")
    assert page == said(axisrig, "--format", "markdown"), (
        "axisrig params --format markdown > docs/parameters.md"
    )


def test_effective_values_say_where_they_come_from(axisrig: Call) -> None:
    lines = [
        " ".join(line.split()) for line in said(axisrig, "--rig", RIG, "--axis", "Z").splitlines()
    ]
    assert "getriebe[0].window 100 x 0.1 um = 0.01 mm axis-z.lst:14" in lines
    assert "kenngr.vb_messen 16666 um/s = 16.666 mm/s default" in lines
    slope = "getriebe[0].lslope_profil"
    assert f"{slope}.d_stufe_1 800 mm/s2 {slope}.a_stufe_1: axis-z.lst:11" in lines


def test_effective_values_of_a_change_and_of_one_parameter(axisrig: Call) -> None:
    change = ["--set", "set:Z.kenngr.measure.edge=NEG"]
    text = said(axisrig, "--rig", RIG, "kenngr.measure.edge", "--axis", "Z", *change)
    assert text.split() == ["axis", "Z", "kenngr.measure.edge", "NEG", "set:Z.kenngr.measure.edge"]


def test_a_list_is_told_with_what_is_corrected_and_what_does_not_act(
    axisrig: Call, tmp_path: Path
) -> None:
    path = tmp_path / "c.lst"
    path.write_text(
        "kopf.log_achs_name C\nkenngr.achs_typ ACHSTYP_ROTATOR\n"
        "kenngr.probing_offset 500\nkenngr.distc.kp 7\ngetriebe[0].kv 300\n"
        "antr.sercos.mdt_offset 300\n"
    )
    values, notes = said(axisrig, str(path)).split("\n\n")
    assert [" ".join(line.split()) for line in values.splitlines()] == [
        "axis C",
        "kopf.log_achs_name C c.lst:1",
        "kenngr.achs_typ ACHSTYP_ROTATOR c.lst:2",
        "getriebe[0].kv 300 x 0.01/s = 3 1/s c.lst:5",
        "kenngr.probing_offset 500 x 0.0001 deg = 0.05 deg c.lst:3",
        "antr.sercos.mdt_offset 300 c.lst:6",
        "kenngr.dist_ctrl[0].kp 2.0 c.lst:4",
    ]
    assert notes.splitlines()[0].startswith("warning: ID 315010 class 1: ")
    assert notes.splitlines()[1] == "note: antr.sercos.mdt_offset = 300 does not act yet"


def test_a_spindle_and_a_list_of_external_variables_are_reported_to_do_nothing(
    axisrig: Call, tmp_path: Path
) -> None:
    spindle, external = tmp_path / "s.lst", tmp_path / "v.lst"
    spindle.write_text("kenngr.achs_typ ACHSTYP_SPINDEL\n")
    assert "note: kenngr.achs_typ = ACHSTYP_SPINDEL does not act yet" in said(axisrig, str(spindle))
    external.write_text("var[0].name SENSOR\nvar[0].type UNS32\n")
    assert "(external) is read and changes nothing" in said(axisrig, str(external))


@pytest.mark.parametrize(
    ("line", "reported"),
    [
        ("messtyp 9", "value of messtyp (P-CHAN-00057) is outside its range"),
        ("kenngr.messachse 2", "value of kenngr.messachse (P-AXIS-00118) is outside its range"),
        ("var[0].scope HERE", "value of var[i].scope (P-EXTV-00004) is outside its range"),
    ],
)
def test_a_list_with_one_wrong_value_is_one_of_its_kind(
    axisrig: Call, tmp_path: Path, line: str, reported: str
) -> None:
    path = tmp_path / "one.lst"
    path.write_text(f"{line}\n")
    code, _, err = axisrig("params", str(path))
    assert code == 2
    assert reported in err


def test_a_parameter_names_the_one_that_limits_it(axisrig: Call) -> None:
    wanted = "limits       at most getriebe[0].dynamik.vb_max (P-AXIS-00212), corrected"
    assert wanted in said(axisrig, "P-AXIS-00215")


def test_a_list_reports_what_goes_past_another_parameter(axisrig: Call, tmp_path: Path) -> None:
    path = tmp_path / "fast.lst"
    path.write_text(
        "kenngr.vb_messen 300000\ngetriebe[0].lslope_profil.a_stufe_1 900\n"
        "getriebe[0].dynamik.a_max 500\n"
    )
    text = said(axisrig, str(path))
    assert "warning: ID 900522" in text
    assert "(P-AXIS-00011) = 900 mm/s2: to be at most" in text


@pytest.mark.long
def test_differences_of_two_lists_in_both_units(axisrig: Call, tmp_path: Path) -> None:
    other = tmp_path / "other.lst"
    text = (LISTS / "axis-z.lst").read_text(encoding="utf-8")
    other.write_text(text.replace("window                          100 ", "window 250 "), "utf-8")
    lines = said(axisrig, "diff", str(LISTS / "axis-z.lst"), str(other), code=1).splitlines()
    changed = "Z: getriebe[0].window: 100 x 0.1 um = 0.01 mm -> 250 x 0.1 um = 0.025 mm"
    assert lines[2:] == [changed]
    assert said(axisrig, "diff", str(other), str(other)) == "no difference\n"


def test_differences_of_a_rotary_axis_are_in_its_units(axisrig: Call, tmp_path: Path) -> None:
    """0.1 um of a linear axis are 0.0001 deg, 1 um/s is 0.001 deg/s."""
    shown = []
    for kind in ("ACHSTYP_TRANSLATOR", "ACHSTYP_ROTATOR"):
        paths = tmp_path / "one.lst", tmp_path / "other.lst"
        for path, deviation, speed in zip(paths, (10_000, 25_000), (2000, 500), strict=True):
            path.write_text(
                f"kopf.achs_nr 1\nkenngr.achs_typ {kind}\n"
                f"kenngr.dist_ctrl[0].max_deviation {deviation}\n"
                f"kenngr.dist_ctrl[0].v_max {speed}\n",
                encoding="utf-8",
            )
        lines = said(axisrig, "diff", *map(str, paths), code=1).splitlines()[2:]
        shown.append([line.split(": ", 2)[-1] for line in lines])
    assert shown == [
        ["10000 x 0.1 um = 1 mm -> 25000 x 0.1 um = 2.5 mm",
         "2000 um/s = 2 mm/s -> 500 um/s = 0.5 mm/s"],
        ["10000 x 0.0001 deg = 1 deg -> 25000 x 0.0001 deg = 2.5 deg",
         "2000 x 0.001 deg/s = 2 deg/s -> 500 x 0.001 deg/s = 0.5 deg/s"],
    ]  # fmt: skip


def test_differences_count_in_effective_values(axisrig: Call, tmp_path: Path) -> None:
    first, second = tmp_path / "a.lst", tmp_path / "b.lst"
    first.write_text("kenngr.mess_neg_flanke 1\n")
    second.write_text("kenngr.measure.edge NEG\nkenngr.mess_neg_flanke 1\n")
    assert said(axisrig, "diff", str(first), str(second)) == "no difference\n"


def test_differences_of_two_rigs_name_missing_axes(axisrig: Call) -> None:
    rig = str(ROOT / "testplans/rigs/probe-z.toml")
    lines = said(axisrig, "diff", rig, RIG, code=1).splitlines()
    assert f"X: only in {RIG}" in lines
    assert any(line.startswith("Z: getriebe[0].window: ") for line in lines)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ('[drive.servo]\nprofile = "late-status"', "drive.servo.profile: generic -> late-status"),
        ("[drive.servo]\ninput_delay_us = 7", "drive.servo.input_delay_us: 4.0 -> 7.0"),
        ('[plant.z]\nfmu = "AxisRig.Drives.ScrewAxis"',
         "plant.z.fmu: AxisRig.Drives.ServoAxis -> AxisRig.Drives.ScrewAxis"),
        ("[plant.probe.start]\nsurface_mm = 50", "plant.probe.start.surface_mm: 100 -> 50"),
        ("[cycle]\nbuffer_cycles = 5", "cycle.buffer_cycles: 0 -> 5"),
        ("[segment.can1]\nbitrate = 500_000", "segment.can1.bitrate: 1000000 -> 500000"),
    ],
)  # fmt: skip
def test_differences_of_two_rigs_are_not_of_their_lists_alone(
    axisrig: Call, tmp_path: Path, changes: str, line: str
) -> None:
    """It was `no difference` where drive, delay and plant differed."""
    base, other = ROOT / "testplans/rigs/probe-z.toml", tmp_path / "other.toml"
    other.write_text(f'base = "{base}"\n{changes}\n', encoding="utf-8")
    assert line in said(axisrig, "diff", str(base), str(other), code=1).splitlines()
    same = tmp_path / "same.toml"
    same.write_text(f'base = "{base}"\ntitle = "another"\n', encoding="utf-8")
    assert said(axisrig, "diff", str(base), str(same)) == "no difference\n"


def test_the_lists_of_a_rig_as_one(axisrig: Call, tmp_path: Path) -> None:
    one = tmp_path / "axes.lst"
    one.write_text(said(axisrig, "write", RIG), encoding="utf-8")
    rig = tmp_path / "one.toml"
    axes = "".join(f'[axis.{axis}]\nlist = "axes.lst"\n' for axis in "XYZ")
    rig.write_text(f'base = "{RIG}"\ntitle = "one list"\n{axes}', encoding="utf-8")
    assert said(axisrig, "diff", str(rig), RIG) == "no difference\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["no", "such", "thing"], "no parameter fits"),
        (["--axis", "Z"], "belong to --rig"),
        (["diff", "one"], "takes two lists"),
        (["write"], "takes one rig"),
        (["--rig", RIG, "--axis", "Q"], "no such axis"),
        (["diff", "none.lst", "none.lst"], "cannot be read"),
        (["diff", str(LISTS / "axis-z.lst"), str(LISTS / "channel.lst")], "nothing in common"),
        (["--rig", RIG, "P-CHAN-00500", "--axis", "Z"], "no parameter of the rig fits"),
    ],
)
def test_what_makes_no_sense_is_rejected(axisrig: Call, words: list[str], message: str) -> None:
    code, out, err = axisrig("params", *words)
    assert (code, out) == (2, "")
    assert message in err


@pytest.mark.parametrize("number", ["P-AXIS-00518", "P-AXIS-518", "p-axis-0518"])
def test_a_number_is_found_with_and_without_its_leading_zeros(axisrig: Call, number: str) -> None:
    assert said(axisrig, number).startswith("P-AXIS-00518  kenngr.measure.edge\n")
