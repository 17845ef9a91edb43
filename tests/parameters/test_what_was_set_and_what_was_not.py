"""Inputs that only follow another one, parameters of a second place, names in several words."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, start_up
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES

Listed = Callable[..., ParameterSet]
Refused = Callable[..., UserError]

# Of the second encoder (P-AXIS-00230, 00422 to 00424): what is no default of theirs
OF_THE_SECOND = {
    "vz_istw": "1",
    "encoder_resolution_num": "5",
    "encoder_resolution_denom": "7",
    "mode_act_pos": "2",
}


@pytest.mark.parametrize("name", OF_THE_SECOND)
def test_a_parameter_of_the_second_encoder_acts_for_it_and_not_for_the_first(name: str) -> None:
    axis, value = ParameterSet("axis"), OF_THE_SECOND[name]
    axis.set(f"lr_hw[1].{name}", value, "plan.csv")
    assert axis.integer(f"lr_hw[1].{name}") == int(value)
    with pytest.raises(UserError, match="does not act yet") as caught:
        axis.set(f"lr_hw[0].{name}", value, "plan.csv")
    assert f"lr_hw[0].{name} = {value} is known to the manuals" in caught.value.message
    assert not axis.is_set(f"lr_hw[0].{name}")


@pytest.mark.parametrize("name", OF_THE_SECOND)
def test_a_list_may_hold_it_for_the_first_and_it_is_named(listed: Listed, name: str) -> None:
    value = OF_THE_SECOND[name]
    axis = listed(f"lr_hw[0].{name} {value}\nlr_hw[1].{name} {value}\n")
    assert [key for key, _ in axis.inert()] == [f"lr_hw[0].{name}"]


@pytest.mark.parametrize("number", sorted(DRIVE_TYPES))
def test_an_input_that_follows_another_one_is_not_corrected_for_it(
    listed: Listed, number: int
) -> None:
    """The hardware of the PLC has 255 inputs (FCT-C4 7.4); those of a drive were not set."""
    axis = listed(
        f"kenngr.antr_typ {number}\nkenngr.measure.signal PLC_EXT_LATCH_CONTROL\n"
        "kenngr.measure.input 200\n"
    )
    assert [alarm.id for alarm in start_up(axis, "Z") if alarm.id in (110614, 110622)] == []
    assert axis.integer("kenngr.measure.input") == 200
    assert axis.integer("kenngr.measure.probe[0].input") == 200


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("kenngr.hub messtaster", "kenngr.hub messtaster"),
        ("kenngr.hub messtaster ; in 0.1 um", "kenngr.hub messtaster"),
    ],
)
def test_a_name_in_two_words_is_shown_with_both(refused: Refused, line: str, value: str) -> None:
    error = refused(f"kenngr.messachse 1\n{line}\n")
    assert (error.message, error.line, error.column) == ("damaged parameter name", 2, 1)
    assert error.value == value
    assert error.hint == "it means kenngr.hub_messtaster"
