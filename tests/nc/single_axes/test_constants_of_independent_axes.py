"""What constants of INDP_SYN and INDP_ASYN show before a run is what the run ends with."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.text.check import check_program

XYZ = ("X", "Y", "Z")
ABOVE_0 = "which has to be above 0"
UP_TO_100 = f"{ABOVE_0} and at most 100"


def notes(text: str) -> list[str]:
    return [note.text for note in check_program(f"G0 Y1\n{text}", "p.nc", XYZ).notes]


@pytest.mark.parametrize("word", ["INDP_SYN", "INDP_ASYN"])
@pytest.mark.parametrize(
    ("options", "reason", "alarm_id"),
    [
        ("FEED=0", f"FEED=0, {ABOVE_0}", 50603),
        ("G01 FEED=-5", f"FEED=-5, {ABOVE_0}", 50603),
        ("G1 TIME=0", f"TIME=0, {ABOVE_0}", 50603),
        ("TIME=-0.5", f"TIME=-0.5, {ABOVE_0}", 50603),
        ("FEED_MAX_WEIGHT=0", f"FEED_MAX_WEIGHT=0, {UP_TO_100}", 50603),
        ("FEED_MAX_WEIGHT=100.5", f"FEED_MAX_WEIGHT=100.5, {UP_TO_100}", 50603),
        ("FEED=5 ACC_WEIGHT=0", f"ACC_WEIGHT=0, {UP_TO_100}", 50603),
        ("FEED=5 ACC_WEIGHT=101", f"ACC_WEIGHT=101, {UP_TO_100}", 50603),
        ("G00 RAPID_ACC_WEIGHT=0", f"RAPID_ACC_WEIGHT=0, {UP_TO_100}", 50603),
        ("G0 RAPID_ACC_WEIGHT=101", f"RAPID_ACC_WEIGHT=101, {UP_TO_100}", 50603),
        ("G00 FEED=5", "FEED with G0", 50603),
        ("G00 TIME=5", "TIME with G0", 50603),
        ("G00 FEED_MAX_WEIGHT=5", "FEED_MAX_WEIGHT with G0", 50603),
        ("G00 G01 FEED=0", "G0 and G1 at a time", 900194),
    ],
)
def test_a_check_notes_what_ends_the_run(run, word: str, options: str, reason: str, alarm_id: int):
    text = f"X[{word} POS=10 {options}]"
    assert notes(text) == [f"a run ends here: X[{word} ..] has {reason} (ID {alarm_id})"]
    with pytest.raises(Alarm) as caught:
        run(f"G0 Y1\n{text}")
    assert (caught.value.id, caught.value.place) == (alarm_id, "test.nc line 2")


@pytest.mark.parametrize("word", ["INDP_SYN", "INDP_ASYN"])
@pytest.mark.parametrize(
    "options",
    [
        "FEED=0.001", "TIME=0.001", "FEED_MAX_WEIGHT=100", "FEED_MAX_WEIGHT=0.1",
        "FEED=500 ACC_WEIGHT=100", "G00 RAPID_ACC_WEIGHT=100", "G00 ACC_WEIGHT=0",
        "G01 FEED=5 RAPID_ACC_WEIGHT=0", "FEED=P1", "G00 RAPID_ACC_WEIGHT=P1",
    ],
)  # fmt: skip
def test_what_a_run_carries_out_is_not_noted(run, word: str, options: str):
    """A weight of the other kind of motion is not looked at, and a variable shows in the run."""
    text = f"P1=1\nX[{word} POS=10 {options}]"
    assert notes(text) == []
    run(text)
