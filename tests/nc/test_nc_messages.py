"""#MSG: text, values, receivers."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import Message, Wait


def messages(run, text, **options):
    return [c for c in run(text, **options) if isinstance(c, Message)]


@pytest.mark.parametrize(
    ("words", "receiver", "synchronous"),
    [
        ("#MSG", "", False),
        ("#MSG SYN", "", True),
        ("#MSG HMI", "HMI", False),
        ("#MSG SYN PLC", "PLC", True),
        ("#MSG ISG_DIAG_BED", "ISG_DIAG_BED", False),
        ("#MSG SYN EVENT_LOGGER", "EVENT_LOGGER", True),
        ("#MSG INFO", "INFO", False),
        ("#MSG INFO SYN HMI", "INFO HMI", True),
        ("#msg syn diag", "DIAG", True),
    ],
)
def test_the_words_say_who_gets_it_and_when(run, words, receiver, synchronous):
    """Programming manual 507845131 and 207157899."""
    (message,) = messages(run, f'{words} ["RED,%d,BOLD", 20]')
    assert (message.text, message.receiver) == ("RED,20,BOLD", receiver)
    assert message.synchronous is synchronous
    assert message.shown == (f"{receiver}: RED,20,BOLD" if receiver else "RED,20,BOLD")


def test_synchronous_ones_wait_for_the_machine(run):
    commands = run('G0 X1\n#MSG SYN HMI ["there"]')
    assert [type(c).__name__ for c in commands[:3]] == ["LinearMove", "Wait", "Message"]
    assert not any(isinstance(c, Wait) for c in run('G0 X1\n#MSG HMI ["decoded"]'))


def test_a_text_variable_in_a_message(run):
    text = '#VAR\nV.P.PART : STRING[20] = "flange"\n#ENDVAR\n#MSG ["part %s, %s", V.P.PART, 2]'
    (message,) = messages(run, text.replace(", 2]", ", V.P.PART]"))
    assert message.text == "part flange, flange"


@pytest.mark.parametrize(
    ("text", "value", "element"),
    [
        ('P1=2.5\n#MSG ["%d", P1]', "2.5", "%d"),
        ('#VAR\nV.P.T : STRING = "a"\n#ENDVAR\n#MSG ["%f", V.P.T]', "a", "%f"),
    ],
)
def test_900107_for_a_value_that_its_format_cannot_show(run, text, value, element):
    with pytest.raises(Alarm) as caught:
        run(text)
    assert caught.value.id == 900107
    assert (caught.value.values["value"], caught.value.values["format"]) == (value, element)


@pytest.mark.parametrize(
    ("element", "value", "text"),
    [
        ("%f", "-0.0000001", "0.000000"),
        ("%.3f", "0*[-1]", "0.000"),
        ("%8.2f", "-0.004", "    0.00"),
        ("%.3f", "-0.0006", "-0.001"),
        ("%g", "0*[-1]", "0"),
        ("%s", "0*[-1]", "0"),
        ("%d", "0*[-1]", "0"),
        ("%e", "-0.0000001", "-1.000000e-07"),
    ],
)
def test_nothing_has_no_sign(run, element, value, text):
    (message,) = messages(run, f'P1={value}\n#MSG ["{element}", P1]')
    assert message.text == text
