"""Parameters of an encoder that act for the second one only."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet

Listed = Callable[..., ParameterSet]

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
