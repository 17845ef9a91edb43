"""The topics of the report, in the order of the page.

A new topic is a folder with `signals`, `words`, `section` and `section.html`, and a line in TOPICS.
"""

from axisrig.reports.distance import section as distance
from axisrig.reports.distance import signals as distance_signals
from axisrig.reports.distance import words as distance_words
from axisrig.reports.fixed_stop import section as fixed_stop
from axisrig.reports.fixed_stop import signals as fixed_stop_signals
from axisrig.reports.fixed_stop import words as fixed_stop_words
from axisrig.reports.kinematics import section as kinematics
from axisrig.reports.kinematics import signals as kinematics_signals
from axisrig.reports.parts.topic import ReportTopic

TOPICS: tuple[ReportTopic, ...] = (
    ReportTopic(
        "fixed_stop",
        "axisrig.reports.fixed_stop",
        fixed_stop.sections,
        fixed_stop_signals.with_signals,
        fixed_stop_signals.plots,
        fixed_stop_words.LEGEND,
    ),
    # Before distance control, which drops what the plant gave it
    ReportTopic(
        "kinematics",
        "axisrig.reports.kinematics",
        kinematics.sections,
        kinematics_signals.with_signals,
        kinematics_signals.plots,
        kinematics_signals.LEGEND,
    ),
    ReportTopic(
        "distance",
        "axisrig.reports.distance",
        distance.sections,
        distance_signals.with_signals,
        distance_signals.plots,
        distance_words.LEGEND,
    ),
)
