"""What a rig makes of the values of a DCF."""

import os
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from tests.eds_changes import changed

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen.checks import axis_steps
from axisrig.bench.rig.canopen.eds_words import commissioned, eds_warnings
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.startup_steps import Write as WriteStep
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
DRIVE = "[drive.servo]\nlead_mm = 10.0\n"
EDS = eds_text(DriveProfile())


def test_values_of_a_dcf_are_written_before_what_the_rig_sets(
    with_eds: Callable[..., Settings],
) -> None:
    """Not those of PDOs, mode and commands, which are the kernel's; the rig's own writes follow."""
    text = changed(EDS, "6065", ParameterValue="0x1000")
    text = changed(text, "6083", ParameterValue="77")
    text = changed(changed(text, "6060", ParameterValue="1"), "1800sub2", ParameterValue="254")
    settings = with_eds(text, 'sdo = [["0x6065:0", 5000]]', suffix="dcf")
    check_rig(settings)
    steps = [step for step in axis_steps(settings, "Z") if isinstance(step, WriteStep)]
    written = [(step.index, int.from_bytes(step.data, "little")) for step in steps]
    assert [each for each in written if each[0] in (0x6065, 0x6083)] == [
        (0x6065, 0x1000),
        (0x6083, 77),
        (0x6065, 5000),
    ]
    assert [value for index, value in written if index == 0x6060] == [8]
    assert [each for each in eds_warnings(settings) if "2 values" in each]


@pytest.mark.parametrize(
    ("section", "value", "message"),
    [
        ("607E", "0x80", "reverses the position"),
        ("607E", "0x40", None),  # the velocity alone
        ("6091sub1", "2", "scales the position otherwise"),
        ("6092sub1", "360000", "scales the position otherwise"),
        ("6092sub2", "1", None),  # as it is
        ("608Fsub1", "4096", "scales the position otherwise"),
        ("6065", "0xFFFFFFFFF", "does not fit"),
    ],
)
def test_a_dcf_that_turns_or_scales_the_position_is_refused(
    with_eds: Callable[..., Settings], section: str, value: str, message: str | None
) -> None:
    text = EDS if f"[{section}]" in EDS else EDS + POLARITY
    settings = with_eds(changed(text, section, ParameterValue=value), suffix="dcf")
    if message is None:
        check_rig(settings)
        return
    with pytest.raises(UserError, match=message):
        check_rig(settings)


@pytest.mark.parametrize(
    ("motor", "shaft", "feed", "feed_shaft", "is_right"),
    [
        (3, 1, 3 * 1_048_576, 1, True),  # a gear of 3: the shaft turns once for 3 of the motor
        (3, 1, 1_048_576, 3, False),  # turned round
        (1, 4, 1_048_576, 4, True),
        (5, 2, 5 * 524_288, 1, True),
        (5, 2, 2 * 524_288, 1, False),
        (2, 2, 2 * 1_048_576, 2, True),
    ],
)
def test_gear_and_feed_of_a_dcf_count_together(
    with_eds: Callable[..., Settings],
    motor: int,
    shaft: int,
    feed: int,
    feed_shaft: int,
    is_right: bool,
) -> None:
    """CiA 402-2: units per turn of the motor = 6092:1/6092:2 / (6091:1/6091:2); here 1048576."""
    text = EDS
    places = ("6091sub1", "6091sub2", "6092sub1", "6092sub2")
    for section, value in zip(places, (motor, shaft, feed, feed_shaft), strict=True):
        text = changed(text, section, ParameterValue=str(value))
    settings = with_eds(text, suffix="dcf")
    if is_right:
        check_rig(settings)
        return
    with pytest.raises(UserError, match="scales the position otherwise"):
        check_rig(settings)


@pytest.mark.parametrize(
    ("increments", "revolutions", "is_right"),
    [
        (1 << 20, 1, True), (3 << 20, 3, True), (1 << 19, 1, False), (1 << 20, 2, False),
        (1 << 21, 1, False),
    ],
)  # fmt: skip
def test_the_encoder_of_a_dcf_counts_by_its_revolutions(
    with_eds: Callable[..., Settings], increments: int, revolutions: int, is_right: bool
) -> None:
    """CiA 402-2, 608F: encoder increments per motor revolutions; the rig has 2^20 on one."""
    text = changed(EDS, "608Fsub1", ParameterValue=str(increments))
    settings = with_eds(changed(text, "608Fsub2", ParameterValue=str(revolutions)), suffix="dcf")
    if is_right:
        check_rig(settings)
        return
    with pytest.raises(UserError, match="scales the position otherwise") as caught:
        check_rig(settings)
    shown = f"{Fraction(increments, revolutions)} increments and 1048576 position units"
    assert str(caught.value.value).startswith(shown)


@pytest.mark.long
@pytest.mark.parametrize("zero", ["6091sub1", "6091sub2", "6092sub1", "6092sub2", "608Fsub2"])
def test_a_0_of_a_dcf_is_its_value_and_not_the_default(
    with_eds: Callable[..., Settings], zero: str
) -> None:
    """Nothing can be said of such a scaling on paper; the start-up compares what the drive says."""
    text = changed(EDS, "608Fsub1", ParameterValue="4096")
    with pytest.raises(UserError, match="scales the position otherwise"):
        check_rig(with_eds(text, suffix="dcf"))
    zeros = changed(text, zero, ParameterValue="0", LowLimit="0")
    check_rig(with_eds(zeros, suffix="dcf"))


POLARITY = """
[607E]
ParameterName=Polarity
ObjectType=0x7
DataType=0x0005
AccessType=rw
DefaultValue=0
PDOMapping=0
"""


@pytest.mark.parametrize(
    ("section", "mm", "words"),
    [
        ("607Dsub2", 90.0, "limits the position to 90.000 mm (607D:2)"),
        ("607Dsub1", -20000.0, None),  # beyond that of the list
        ("6065", 0.5, "window of 0.500 mm (6065)"),
        ("6065", 5.0, None),
        ("6065", 0.0, "window of 0.000 mm (6065)"),  # the tightest one (CiA 402-2)
    ],
)
def test_limits_of_a_dcf_that_act_first_are_named(
    with_eds: Callable[..., Settings], section: str, mm: float, words: str | None
) -> None:
    """1048576 units are 10 mm."""
    value = str(round(mm * 104857.6))
    settings = with_eds(
        changed(EDS, section, ParameterValue=value), "lag_limit_mm = 2.0", suffix="dcf"
    )
    found = [text for text in eds_warnings(settings) if "the drive stops first" in text]
    assert [words in text for text in found] == [True] * (words is not None)


@pytest.mark.long
@pytest.mark.parametrize(
    ("sub", "units", "named"),
    [
        (2, 10_485_760, None), (2, 10_485_759, "kenngr.swe_pos"), (2, 10_485_761, None),
        (1, -5_242_880, None), (1, -5_242_879, "kenngr.swe_neg"), (1, -5_242_881, None),
        (1, 0, "kenngr.swe_neg"), (2, -5_242_880, "kenngr.swe_pos"),
    ],
)  # fmt: skip
def test_limits_of_a_dcf_are_named_only_inside_those_of_the_list(
    rig_file: Write, settings_of: Read, sub: int, units: int, named: str | None
) -> None:
    """The list has -50 mm and 100 mm (in 0.1 um); 10485760 units are 100 mm, which is no less."""
    path = rig_file((DRIVE, f'{DRIVE}eds = "foreign.dcf"\n'))
    text = changed(EDS, f"607Dsub{sub}", ParameterValue=str(units))
    (path.parent / "foreign.dcf").write_text(text, encoding="utf-8")
    settings = settings_of(path, "set:Z.kenngr.swe_neg=-500000", "set:Z.kenngr.swe_pos=1000000")
    found = [text for text in eds_warnings(settings) if "the drive stops first" in text]
    assert [f"(607D:{sub})" in text and f"({named})" in text for text in found] == [True] * (
        named is not None
    )


def test_node_and_bit_rate_of_a_dcf_that_changes_are_read_again(tmp_path: Path) -> None:
    """0 and a missing key say nothing; an EDS has no such section."""
    path = tmp_path / "drive.dcf"
    commissioning = "[DeviceComissioning]\nNodeID={node}\nBaudrate={rate}\n"
    for number, (node, rate, found) in enumerate(
        [(3, 500, (3, 500_000)), (7, 500, (7, 500_000)), (7, 0, (7, None)), (0, 20, (None, 20_000))]
    ):
        path.write_text(EDS + "\n" + commissioning.format(node=node, rate=rate), encoding="ascii")
        os.utime(path, ns=(0, 10**9 * (number + 1)))
        assert commissioned(str(path)) == found
    bare = tmp_path / "drive.eds"
    bare.write_text(EDS, encoding="ascii")
    assert commissioned(str(bare)) == (None, None)
