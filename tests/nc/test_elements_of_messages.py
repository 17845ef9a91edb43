"""Format elements of #MSG as C prints them: width, flags, precision, both cases, their errors.

ISO C 7.21.6.1; the letters of the manual: TF5200 diagnosis manual, ID 21232.
"""

import pytest
from tests.nc.conftest import of, texts

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import Message


def shown(run, text, *values):
    """The text of a message whose values come from variables."""
    written = "".join(f"V.P.A{place}={value}\n" for place, value in enumerate(values))
    names = "".join(f", V.P.A{place}" for place in range(len(values)))
    (printed,) = texts(run(f'{written}#MSG ["{text}"{names}]'))
    return printed


@pytest.mark.parametrize(
    ("text", "values", "wanted"),
    [
        ("|%5s|", ['"ab"'], "|   ab|"),
        ("|%-5s|", ['"ab"'], "|ab   |"),
        ("|%.1s|", ['"ab"'], "|a|"),
        ("|%6s|", [2.5], "|   2.5|"),  # a number as text
        ("|%-6s|", [2.5], "|2.5   |"),
        ("|%5d|", [42], "|   42|"),
        ("|%-5d|", [42], "|42   |"),
        ("|%05d|", [-42], "|-0042|"),
        ("|%+d|", [42], "|+42|"),
        ("|% i|", [42], "| 42|"),
        ("|%.3d|", [7], "|007|"),
        ("|%8.2f|", [3.14159], "|    3.14|"),
        ("|%+.1f|", [3.14159], "|+3.1|"),
        ("|%#.0f|", [3], "|3.|"),
        ("|%12.3e|", [1234.5], "|   1.234e+03|"),
        ("|%.3g|", [0.00012345], "|0.000123|"),
        ("%F %D %S", [1.5, 2, '"a"'], "1.500000 2 a"),
        ("%6.1F|%-4D|%3S", [1.25, 2, '"a"'], "   1.2|2   |  a"),
    ],
)
def test_an_element_is_put_out_as_c_does(run, text, values, wanted):
    assert shown(run, text, *values) == wanted


@pytest.mark.parametrize(
    ("text", "values", "wanted"),
    [
        ("100%%", [], "100%"),
        ("%%%d%%", [5], "%5%"),
        ("%% of %d", [5], "% of 5"),
        ("%d, then the rest", [5], "5, then the rest"),
        ("%d%d", [1, 2], "12"),
        ("%d and %s and %d", [1, '"two"', 3], "1 and two and 3"),
        ("no value", [], "no value"),
    ],
)
def test_text_between_the_elements_stays(run, text, values, wanted):
    assert shown(run, text, *values) == wanted


@pytest.mark.parametrize(
    ("element", "value", "reported"),
    [
        ("%5d", 1234.5, "1234.5"),
        ("%-3i", -0.25, "-0.25"),
        ("%05d", 2.5, "2.5"),
        ("%8.2f", '"a"', "a"),
        ("%+d", '"a"', "a"),
        ("%g", '"a"', "a"),
    ],
)
def test_900107_names_the_element_as_it_was_written(run, element, value, reported):
    with pytest.raises(Alarm) as caught:
        shown(run, f"at {element} mm", value)
    assert caught.value.id == 900107
    assert caught.value.values == {"value": reported, "format": element}


@pytest.mark.parametrize("value", [3, -3, 0])
def test_a_whole_number_fits_a_whole_element(run, value):
    assert shown(run, "%d %i", value, value) == f"{value} {value}"


@pytest.mark.parametrize(
    ("command", "column", "value"),
    [
        ('#MSG ["abc %5.1q", 1]', 12, "%5.1q"),  # where the element begins
        ('#MSG ["%d %", 1]', 11, "%"),
        ('#MSG SYN ["%d%x", 1, 2]', 14, "%x"),
    ],
)
def test_an_unknown_element_is_shown_where_it_is(run, command, column, value):
    with pytest.raises(UserError) as caught:
        run(f"P1=1\n  {command}")
    error = caught.value
    assert (error.line, error.column, error.value) == (2, column + 2, value)
    assert error.allowed == "%f, %d, %i, %s, %e, %g, %F, %D, %S, %%"


@pytest.mark.parametrize(
    ("arguments", "given", "elements"),
    [
        ('"%d"', 0, 1),
        ('"%d %s", 1', 1, 2),
        ('"none", 1', 1, 0),
        ('"%d%%", 1, 2', 2, 1),
    ],
)
def test_as_many_values_as_elements(run, arguments, given, elements):
    with pytest.raises(UserError) as caught:
        run(f"#MSG [{arguments}]")
    error = caught.value
    assert "number of format elements" in error.message
    assert (error.value, error.allowed) == (f"{given} values", f"{elements} values")


@pytest.mark.parametrize(
    ("arguments", "place", "element"),
    [
        ('"%5.1f", "a"', 1, "%5.1f"),
        ('"%s", 1', 1, "%s"),
        ('"%d %-4s", 1, 2', 2, "%-4s"),
        ('"%s %d %03d", "a", 1, "b"', 3, "%03d"),
    ],
)
def test_a_value_of_the_wrong_kind_is_named_by_its_place(run, arguments, place, element):
    with pytest.raises(UserError) as caught:
        run(f"#MSG [{arguments}]")
    error = caught.value
    assert error.message == f"value {place} does not fit its format element"
    assert (error.value, error.allowed) == (element, "%s for a text, any other for a number")


def test_the_numbers_of_a_message_are_kept_without_its_texts(run):
    text = '#MSG ["%s %d %s %.1f", "a", 7, "b", 2.25]'
    (message,) = of(run(text), Message)
    assert message.values == (7.0, 2.25)
    assert message.text == "a 7 b 2.2"
