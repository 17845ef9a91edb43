"""#ERROR and #MSG: what an error of a program shows, and what is no number or class of one."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message, Wait, Warn

CLASSES = {0: 900130, 2: 900131, 7: 900132}


def alarm_of(run, text):
    with pytest.raises(Alarm) as caught:
        run(text)
    return caught.value


# (what is written, keyword, value that is shown, what is allowed)
REFUSED = [
    ("ID=7 RC=3", "RC", 3, "0, 2 or 7"),
    ("ID=7 RC=-1", "RC", -1, "0, 2 or 7"),
    ("ID=7 RC=0.5", "RC", 0.5, "0, 2 or 7"),
    ("ID=7 RC=2.5", "RC", 2.5, "0, 2 or 7"),
    ("RC=8", "RC", 8, "0, 2 or 7"),
    ("ID=1001 RC=2", "ID", 1001, "1 to 1000"),
    ("ID=1001", "ID", 1001, "1 to 1000"),
    ("ID=-1 RC=0", "ID", -1, "1 to 1000"),
    ("ID=1.5 RC=7", "ID", 1.5, "1 to 1000"),
    ("ID=1002 RC=5", "ID", 1002, "1 to 1000"),  # both: the number first
]


@pytest.mark.parametrize(("text", "keyword", "value", "allowed"), REFUSED)
def test_a_number_or_class_that_there_is_not_is_the_value_that_is_shown(
    run, text, keyword, value, allowed
):
    alarm = alarm_of(run, f"N10 G0 X1\nN20 #ERROR [{text}]")
    assert alarm.id == 900133
    assert alarm.values == {"keyword": keyword, "value": value, "allowed": allowed}
    assert "N20" in alarm.place


def test_a_text_of_a_variable_is_no_number_and_no_class(run):
    text = '#VAR\nV.P.T : STRING = "two"\n#ENDVAR\n#ERROR [ID={} RC={}]'
    for number, reaction, keyword in (("V.P.T", "2", "ID"), ("2", "V.P.T", "RC")):
        alarm = alarm_of(run, text.format(number, reaction))
        assert (alarm.id, alarm.values["keyword"], alarm.values["value"]) == (
            900133, keyword, "two",
        )  # fmt: skip


@pytest.mark.parametrize(("reaction", "alarm_id"), CLASSES.items())
@pytest.mark.parametrize("number", [1, 500, 1000])
def test_the_class_chooses_the_alarm_and_the_number_is_that_of_the_program(
    run, reaction, alarm_id, number
):
    """Error management 207457163: 0 a warning, 2 the end of the program, 7 a fatal error."""
    text = f"N10 G0 X1\nN20 #ERROR [RC={reaction} ID={number}]\nX2"
    if reaction == 0:
        (alarm,) = [each.alarm for each in run(text) if isinstance(each, Warn)]
    else:
        alarm = alarm_of(run, text)
    assert (alarm.id, alarm.values["number"]) == (alarm_id, number)
    assert "N20" in alarm.place
    assert alarm.ends_program is (reaction != 0)


def test_without_number_it_is_0_and_without_class_2(run):
    for text, alarm_id, number in (
        ("#ERROR [RC=7]", 900132, 0), ("#ERROR [ID=4]", 900131, 4), ("#ERROR [MID=3]", 900131, 0),
    ):  # fmt: skip
        alarm = alarm_of(run, text)
        assert (alarm.id, alarm.values["number"]) == (alarm_id, number)


def test_a_number_of_0_is_that_of_an_error_without_one(run):
    assert alarm_of(run, "#ERROR [ID=0 RC=2]").values["number"] == 0


def test_values_are_shown_in_the_order_in_which_they_are_written(run):
    """Numbers as they are, without zeros; texts; results of expressions."""
    text = 'P1=2\n#ERROR [PV2=1.50 ID=9 PM1="low" MID=P1 RC=2 PV1=P1/4 PM5=-3]'
    details = alarm_of(run, text).values["details"]
    assert details == "PV2 1.5, PM1 low, MID 2, PV1 0.5, PM5 -3"


def test_what_follows_a_warning_is_still_run_and_each_warning_comes_up(run):
    commands = run("#ERROR [ID=1 RC=0]\nG0 X1\n#ERROR [ID=2 RC=0]\nG0 X2")
    kinds = [type(each).__name__ for each in commands[:4]]
    assert kinds == ["Warn", "LinearMove", "Warn", "LinearMove"]
    assert [each.alarm.values["number"] for each in commands if isinstance(each, Warn)] == [1, 2]


# #MSG


def test_the_numbers_of_a_message_are_kept_beside_its_text(run):
    """Texts are no numbers; the order is that of the values."""
    text = '#VAR\nV.P.T : STRING = "part"\n#ENDVAR\nP1=2.5\n#MSG ["%s %f %d", V.P.T, P1, 7]'
    (message,) = [each for each in run(text) if isinstance(each, Message)]
    assert message.text == "part 2.500000 7"
    assert message.values == (2.5, 7.0)


@pytest.mark.parametrize("kind", ["MSG", "MSG INFO"])
@pytest.mark.parametrize("receiver", ["", "ISG_DIAG_BED", "DIAG", "HMI", "PLC", "EVENT_LOGGER"])
def test_a_message_waits_for_the_machine_only_where_it_is_synchronous(run, kind, receiver):
    for mode in ("", "SYN"):
        commands = run(f'N10 G0 X1\nN20 #{" ".join([kind, mode, receiver])} ["a"]')
        (message,) = [each for each in commands if isinstance(each, Message)]
        assert message.synchronous is (mode == "SYN")
        info = "INFO " if "INFO" in kind else ""
        assert message.receiver == f"{info}{receiver}".strip()
        before = commands[: commands.index(message)]
        assert any(isinstance(each, Wait) for each in before) is (mode == "SYN")
        assert message.block.number == 20


def test_900107_shows_the_first_value_that_does_not_fit_and_its_block(run):
    alarm = alarm_of(run, 'P1=2 P2=1.5\nN30 #MSG ["%d %d", P1, P2]')
    assert (alarm.id, alarm.values) == (900107, {"value": "1.5", "format": "%d"})
    assert "N30" in alarm.place
