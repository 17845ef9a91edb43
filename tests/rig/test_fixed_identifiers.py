"""Telegrams that a drive sends by its file and the rig leaves out; the words for such a drive."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.eds_changes import changed

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen.schedule import fixed_frames
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.settings import Settings

EDS = eds_text(DriveProfile())
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


@pytest.mark.parametrize(
    ("keys", "frames"),
    [
        ({"AccessType": "ro", "DefaultValue": "$NODEID+0x480"}, 1),
        ({"AccessType": "const", "DefaultValue": "0x40000480"}, 1),
        ({"AccessType": "ro", "DefaultValue": "$NODEID+0x80000480"}, 0),  # bit 31: not valid
        ({"AccessType": "ro", "DefaultValue": ""}, 0),  # the file names no identifier
        ({"AccessType": "rw", "DefaultValue": "$NODEID+0x480"}, 0),  # it is switched off
    ],
)
def test_a_tpdo_that_nobody_mapped_comes_where_its_identifier_is_fixed_and_valid(
    with_eds: Callable[..., Settings], keys: dict[str, str], frames: int
) -> None:
    found = fixed_frames(with_eds(changed(EDS, "1803sub1", **keys)), "Z")
    assert len(found) == frames


def test_a_drive_by_a_file_is_named_by_it(with_eds: Callable[..., Settings]) -> None:
    drive = with_eds(EDS).rig.drive["servo"]
    assert drive.in_words == f"EDS {drive.eds}"
    assert settings_of(RIGS / "probe-z.toml", []).rig.drive["servo"].in_words == "profile generic"
