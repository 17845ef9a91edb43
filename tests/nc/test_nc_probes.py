"""#MEAS and its relatives: what they hand on, what they refuse, how long they hold."""

import re
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import (
    DefaultProbes,
    MeasuringRun,
    Message,
    PrepareProbe,
    ProbeSettings,
)
from axisrig.kernel.nc.text.parser import parse_program

RUN = "\nG100 X9 F100"


def _of(commands: list[Any], kind: type) -> list[Any]:
    return [command for command in commands if isinstance(command, kind)]


def _alarm(run: Any, text: str) -> Alarm:
    with pytest.raises(Alarm) as caught:
        run(text)
    return caught.value


def _type(run: Any, text: str) -> str:
    return _of(run(f'{text}\n#MSG["%d", V.G.MEAS_TYPE]'), Message)[-1].text


def test_type_holds_until_another_is_chosen(run) -> None:
    assert _type(run, "#MEAS[TYPE=2]") == "2"
    assert _type(run, "#MEAS MODE[3]\n#MEAS[TYPE=2]") == "2"
    assert _type(run, "#MEAS[TYPE=2]\n#MEAS MODE[3]") == "3"
    assert _type(run, "#MEAS[TYPE=2]\n#MEAS MODE") == "1"
    assert _type(run, "#MEAS[TYPE=2]\n#MEAS DEFAULT") == "1"
    assert _of(run(f"#MEAS[TYPE=3]{RUN}"), MeasuringRun)[0].measuring_type == 3


@pytest.mark.provokes(900104, 2)
def test_900104_for_a_type_that_does_not_exist(run) -> None:
    assert _alarm(run, "N7 #MEAS[TYPE=V.A.ABS.X]").id == 900104


def test_err_no_signal_goes_with_every_run_behind_it(run) -> None:
    before, after = _of(run(f"{RUN}\nG0 X0\n#MEAS[ERR_NO_SIGNAL=0]{RUN}"), MeasuringRun)
    assert (before.error_no_signal, after.error_no_signal) == (None, False)
    (message,) = _of(run(f"#MEAS[TYPE=4 ERR_NO_SIGNAL=1]{RUN}"), MeasuringRun)
    assert (message.measuring_type, message.error_no_signal) == (4, True)
    (message,) = _of(run(f"#MEAS[ERR_NO_SIGNAL=1]\n#MEAS DEFAULT{RUN}"), MeasuringRun)
    assert message.error_no_signal is None


@pytest.mark.parametrize(
    ("text", "settings"),
    [
        ("AX=Y EDGE=NEG", ("Y", "NEG", None, None)),
        ("AXNR=3 INPUT=2", ("Z", None, 2, None)),
        ("AX=X INPUT=PROBE1 EDGE=POS", ("X", "POS", None, 1)),
        ("AX=X SIGNAL=DRIVE", ("X", None, None, None)),
        ("AX=X SIGNAL=FIXED_STOP", ("X", None, None, None)),
        ("AX=Z SIGNAL=DRIVE EDGE=NEG INPUT=1+1", ("Z", "NEG", 2, None)),
    ],
)
def test_an_axis_gets_its_settings(run, text: str, settings: tuple[Any, ...]) -> None:
    (message,) = _of(run(f"#MEAS[{text}]"), ProbeSettings)
    assert (message.axis, message.edge, message.probe_input, message.probe) == settings
    source = re.search(r"SIGNAL=(\w+)", text)
    assert message.source == (source and source[1])


def test_default_and_preparation_are_handed_on(run) -> None:
    assert len(_of(run("#MEAS DEFAULT"), DefaultProbes)) == 1
    assert _of(run("#MEAS PREPARE[AXNR=2]"), PrepareProbe)[0].axes == ("Y",)
    assert _of(run("#MEAS PREPARE[AX=Z]"), PrepareProbe)[0].axes == ("Z",)
    assert _of(run("#MEAS PREPARE[AX=Z AXNR=2]"), PrepareProbe)[0].axes == ("Z", "Y")
    assert _of(run("#MEAS PREPARE[AXNR=2 AX=Z]"), PrepareProbe)[0].axes == ("Y", "Z")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("SIMU_OFFSET=1 TRIGGER", ("TRIGGER", "SIMU_OFFSET")),
        ("SIMU_OFFSET=1 AX=X", ("AX", "SIMU_OFFSET")),
        ("AXNR=1 TRIGGER", ("TRIGGER", "AXNR")),
        ("AX=X AXNR=1 EDGE=NEG", ("AXNR", "AX")),
        ("AX=X G107 G108", ("G108", "G107")),
        ("EDGE=NEG", ("EDGE", "AX=")),
        ("TYPE=2 INPUT=1", ("INPUT", "AX=")),
    ],
)
def test_keywords_that_exclude_each_other_and_settings_of_no_axis_are_refused(
    run, text: str, message: tuple[str, str]
) -> None:
    with pytest.raises(UserError) as caught:
        run(f"#MEAS[{text}]")
    assert all(word in str(caught.value) for word in message)


@pytest.mark.parametrize("text", ["#MEAS", "#MEAS[]", "#MEAS[AX=X]", "#MEAS[AXNR=1]"])
def test_a_command_that_would_change_nothing_is_refused(run, text: str) -> None:
    with pytest.raises(UserError, match="#MEAS says nothing"):
        run(text)


def test_a_preparation_names_its_axis(run) -> None:
    with pytest.raises(UserError, match="AX="):
        run("#MEAS PREPARE")


@pytest.mark.provokes(20312, 2)
def test_20312_for_the_number_of_no_axis(run) -> None:
    for number in ("7", "V.A.ABS.X+1.5"):
        assert _alarm(run, f"N7 #MEAS[AXNR={number} EDGE=NEG]").id == 20312


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("AX=X INPUT=256", ("INPUT", "256", "1 .. 255 PROBE0 PROBE1")),
        ("AX=X INPUT=PROBE2", ("INPUT", "PROBE2", "1 .. 255 PROBE0 PROBE1")),
        ("ERR_NO_SIGNAL=V.A.ABS.X+2", ("ERR_NO_SIGNAL", "2", "0 1")),
    ],
)
@pytest.mark.provokes(900227, 2)
def test_900227_for_values_that_cannot_be(run, text: str, values: tuple[str, ...]) -> None:
    alarm = _alarm(run, f"N7 #MEAS[{text}]")
    assert alarm.id == 900227
    assert tuple(alarm.values[name] for name in ("keyword", "value", "allowed")) == values


@pytest.mark.parametrize(
    ("text", "word", "section"),
    [
        ("#MEAS[TRIGGER]", "#MEAS [TRIGGER]", "P-CHAN-00257"),
        ("#MEAS[AX=X G107]", "#MEAS [G107]", "207092107"),
        ("#MEAS[AX=X G108]", "#MEAS [G108]", "207092107"),
        ("G108", "G108", "206213899"),
        ("G107", "G107", "206224907"),
    ],
)
@pytest.mark.provokes(900430, 2)
def test_900430_with_the_section_and_a_note_of_the_check_for_edge_banding(
    run, text: str, word: str, section: str
) -> None:
    alarm = _alarm(run, f"N7 {text}")
    assert (alarm.id, alarm.values["word"]) == (900430, word)
    assert section in str(alarm.values["section"])
    assert "G106" in alarm.entry.remedy
    program = parse_program(f"N7 {text}\n", file="test.nc", axes=("X", "Y", "Z"))
    assert [n.word for block in program.blocks for n in block.not_acting] == [word]


def test_simu_offset_is_a_length_and_ends_with_the_defaults(run) -> None:
    """-1 inch is -25.4 mm; #MEAS DEFAULT takes it off."""
    text = "G70\n#MEAS[SIMU_OFFSET=-1]\nG100 X1 F10\n#MEAS DEFAULT\nG100 X2"
    runs = [command for command in run(text) if isinstance(command, MeasuringRun)]
    assert [one.simulated_offset_mm for one in runs] == [pytest.approx(-25.4), 0.0]
