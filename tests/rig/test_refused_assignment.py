"""A rig that is refused because of a cell or a `--set` is not to blame: the cell is."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

RigWriter = Callable[..., Path]
Read = Callable[..., Settings]


@pytest.mark.parametrize(
    ("assignment", "fragments"),
    [
        ("bus:can1.bitrate=125000", ["the cycle does not fit on segment can1", "with 125000: "]),
        ("bus:all.bitrate=125000", ["the cycle does not fit on segment can1"]),
        ("drive:servo.profile=epos4-like", ["(profile epos4-like)", "0x60BC"]),
        ("set:Z.kopf.log_achs_name=X", ["the list belongs to axis X"]),
    ],
)
def test_what_makes_the_rig_impossible_is_named(
    rig_file: RigWriter, settings_of: Read, assignment: str, fragments: list[str]
) -> None:
    path = rig_file()
    check_rig(settings_of(path))  # good without it
    with pytest.raises(UserError) as refused:
        check_rig(
            settings_of(
                path,
                "set:Z.kenngr.measure.input=2",
                "set:Z.kenngr.measure.edge=POS",
                assignment,
                "drive:servo.lag_limit_mm=2",
            )
        )
    text = str(refused.value)
    assert text.startswith(f"--set {assignment}: ")
    for fragment in fragments:
        assert fragment in text


def test_a_rig_that_is_refused_without_any_assignment_is_to_blame_itself(
    rig_file: RigWriter, settings_of: Read
) -> None:
    path = rig_file(("bitrate = 1_000_000", "bitrate = 125_000"))
    with pytest.raises(UserError) as refused:
        check_rig(settings_of(path, "drive:servo.lag_limit_mm=2", "bus:can1.queue=mailbox"))
    assert (refused.value.file, refused.value.line) == (str(path), 9)
