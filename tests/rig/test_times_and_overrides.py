"""Times and overrides of the PLC side: what each key takes, to the last value that is allowed."""

import pytest

from axisrig.bench.rig.plc.override import OverrideCourse, read_override
from axisrig.bench.rig.plc.times import duration, lasting
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, S


@pytest.mark.parametrize(
    ("text", "time_ns"), [("1ns", 1), ("300ms", 300 * MS), ("600s", 600 * S), (".5s", S // 2)]
)
def test_a_time_from_a_nanosecond_to_ten_minutes(text: str, time_ns: int) -> None:
    assert duration({"for": text}) == time_ns
    assert lasting("over", {"over": text}) == time_ns


@pytest.mark.parametrize("text", ["0s", "600.001s", "601s", "-1s", "5", "", "5 ms", "1min"])
def test_another_time_is_refused_with_what_may_be_written(text: str) -> None:
    with pytest.raises(UserError) as error:
        duration({"for": text})
    assert (
        error.value.allowed
        == "a time up to 600s with its unit (us, ms, s), as for=300ms, or until=M51"
    )
    with pytest.raises(UserError) as error:
        lasting("over", {"over": text})
    assert error.value.allowed == "a time up to 600s with its unit (us, ms, s), as over=300ms"


def test_a_feedhold_has_one_end_and_a_course_may_be_at_once() -> None:
    assert duration({"until": "M51"}) is None
    assert lasting("over", {"for": "1s"}) == 0
    with pytest.raises(UserError, match=r"`for` or `until`"):
        duration({"until": "M51", "for": "1s"})
    with pytest.raises(UserError, match="how long"):
        duration({})


@pytest.mark.parametrize(
    ("value", "highest", "permille"),
    [("0", 100, 0), ("100", 100, 1000), ("57.3", 100, 573), ("0.1", 100, 1), ("200", 200, 2000)],
)
def test_an_override_in_steps_of_a_tenth_of_a_percent(
    value: str, highest: int, permille: int
) -> None:
    found = read_override("Z", "plc:Z.override", value, {"over": "2ms"}, highest)
    assert found == OverrideCourse("Z", permille, 2 * MS)
    assert read_override(None, "plc:override", value, {}, highest).over_ns == 0


@pytest.mark.parametrize(
    ("value", "highest"), [("-0.1", 100), ("100.1", 100), ("200.1", 200), ("50.05", 100)]
)
def test_another_override_is_refused(value: str, highest: int) -> None:
    with pytest.raises(UserError) as error:
        read_override("Z", "plc:Z.override", value, {}, highest)
    assert error.value.allowed == f"0 to {highest}"
