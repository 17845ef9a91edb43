"""The sections of the report that are about several runs, in the order of the page.

A new one is a folder with what writes it, and a line in SECTIONS.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.reports.coverage.section import Coverage, coverage_style
from axisrig.reports.lines.section import lines_section, lines_style
from axisrig.reports.statistics.section import statistics_section, statistics_style
from axisrig.reports.sweeps.searches import searches_section
from axisrig.reports.sweeps.section import Sweep, sweeps, sweeps_section, sweeps_style
from axisrig.reports.sweeps.sensitivity import sensitivity_section


@dataclass(frozen=True)
class Results:
    """What a section is made of: the folder, and what the recordings of its runs have reached."""

    stored: StoredResults
    coverage: Coverage

    @cached_property
    def sweeps(self) -> Sequence[Sweep]:
        """The metrics of cases over their inputs."""
        return sweeps(self.stored)


@dataclass(frozen=True)
class CampaignSection:
    """A section of the page. title: as the contents name it. place: ID of its heading.

    make: writes it, empty where there is nothing of it. style: its rules, empty where another
    section brings them.
    """

    title: str
    place: str
    make: Callable[[Results], Markup]
    style: Callable[[], Markup] = Markup


SECTIONS: tuple[CampaignSection, ...] = (
    CampaignSection(
        "Lines", "lines_title", lambda results: lines_section(results.stored), lines_style
    ),
    CampaignSection(
        "Statistics",
        "statistics_title",
        lambda results: statistics_section(results.stored),
        statistics_style,
    ),
    CampaignSection("Searches", "searches_title", lambda results: searches_section(results.stored)),
    CampaignSection(
        "Sweeps",
        "sweeps_title",
        lambda results: sweeps_section(results.stored, results.sweeps),
        sweeps_style,
    ),
    CampaignSection(
        "Sensitivity",
        "sensitivity_title",
        lambda results: sensitivity_section(results.sweeps),
    ),
    CampaignSection(
        "Coverage", "coverage_title", lambda results: results.coverage.section(), coverage_style
    ),
)
