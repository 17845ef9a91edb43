"""Values that a distance control has taken leave an order in the record; 0 mm is a value too."""

import pytest

from axisrig.kernel.channel.distance.orders import Order, given

VALUES = (None, 0.0, -0.0, 2.5, -2.5)


@pytest.mark.parametrize("axis", ["Z", None])
@pytest.mark.parametrize("by", ["NC", "PLC"])
def test_each_value_that_is_there_is_in_the_order(axis: str | None, by: str) -> None:
    """With 0 as with any other: position alone, distance alone, both; without any no order."""
    for set_pos_mm in VALUES:
        for set_dist_mm in VALUES:
            orders = given(axis, by, set_pos_mm, set_dist_mm, {})
            if set_pos_mm is None and set_dist_mm is None:
                assert orders == []
            else:
                assert orders == [Order(axis, by, set_pos_mm=set_pos_mm, set_dist_mm=set_dist_mm)]


@pytest.mark.parametrize("parameters", [{"kp": 0.0}, {"filter_type": ""}, {"kp": 0.4, "tn_s": 1.0}])
def test_a_parameter_alone_is_an_order_and_later_changes_of_it_are_not_in_it(
    parameters: dict[str, float | str],
) -> None:
    wanted = dict(parameters)
    orders = given("Z", "NC", None, None, wanted)
    wanted["kp"] = 7.0
    assert orders == [Order("Z", "NC", parameters=parameters)]
    assert (orders[0].action, orders[0].is_dry_run) == ("", False)
