"""Every ID that the manuals have for measuring is raised, or docs/ambiguities.md says why not."""

import re
from pathlib import Path

import pytest

from axisrig.kernel.errors import catalogue

TEXT = (Path(__file__).parents[2] / "docs" / "ambiguities.md").read_text(encoding="utf-8")
IDS = (
    *(20138, 20772, 20956, 50050, 50052, 50059, 50061, 50573, 50637, 50664, 50718, 51026, 60207),
    *(44011, 70689, 110508, 110586, 110608, 110611, 110612, 110614, 110622, 110657, 110658, 110757),
    *(21964, 21968, 13413, 13414, 13425),
)
"""FCT-C4, programming manual, TF5200 diagnosis and axis parameter pages."""


@pytest.mark.parametrize("alarm_id", IDS)
def test_an_id_of_measuring_is_raised_or_decided(alarm_id: int) -> None:
    is_decided = re.search(rf"\b{alarm_id}\b", TEXT) is not None
    assert catalogue()[alarm_id].is_raised or is_decided


def test_what_no_part_of_the_bench_raises_is_this() -> None:
    """Block search, edge banding, MC_TouchProbe, TwinCAT, FCT-M8, a package of cycles, a twin."""
    not_raised = {alarm_id for alarm_id in IDS if not catalogue()[alarm_id].is_raised}
    assert not_raised == {
        *(50718, 50573, 44011, 60207, 70689, 21964, 21968, 13413, 13414, 13425),
        110657,
    }
