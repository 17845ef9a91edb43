"""The topics of the judge, and what is asked of all of them.

A new topic is a folder with `metrics` and `findings` (and `truth` where it compares), and a line in
TOPICS.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from axisrig.bench.judge.distance.findings import control_findings, distance_events
from axisrig.bench.judge.distance.metrics import LOOP_METRICS
from axisrig.bench.judge.distance.offset_metrics import OFFSET_METRICS
from axisrig.bench.judge.distance.tool_metrics import TOOL_METRICS
from axisrig.bench.judge.fixed_stop.findings import stop_events, stop_findings
from axisrig.bench.judge.fixed_stop.metrics import STOP_METRICS
from axisrig.bench.judge.kinematics.findings import no_events, tool_findings
from axisrig.bench.judge.kinematics.metrics import KINEMATIC_METRICS
from axisrig.bench.judge.latch.findings import latch_events
from axisrig.bench.judge.latch.metrics import LATCH_METRICS
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.rotary_metrics import TORQUE, in_newton_metres, turned
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.own_metrics import judged_by_own
from axisrig.bench.judge.program.findings import program_events
from axisrig.bench.judge.program.metrics import PROGRAM_METRICS, printed
from axisrig.bench.judge.run_findings import RunFindings, of_facts
from axisrig.bench.judge.statistics.verdict import (
    Reading,
    RunSample,
    judge_statistic,
    readings,
)
from axisrig.bench.plan.checks import Check, CheckResult, judge
from axisrig.bench.plan.own_metrics import OwnModule
from axisrig.bench.plan.statistic_checks import StatisticCheck
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.bench.record.series import MissingSignalError

DISTANCE_METRICS = {**LOOP_METRICS, **OFFSET_METRICS}

TOPICS: tuple[Topic, ...] = (
    Topic("program", PROGRAM_METRICS, program_events),
    Topic("latch", LATCH_METRICS, latch_events),
    Topic("fixed_stop", STOP_METRICS, stop_events, stop_findings),
    Topic("distance", {**DISTANCE_METRICS, **TOOL_METRICS}, distance_events, control_findings),
    Topic("kinematics", KINEMATIC_METRICS, no_events, tool_findings),
)


def observe(
    observed: Observed,
    check: Check,
    topics: Sequence[Topic] = TOPICS,
    module: OwnModule | None = None,
) -> Observation:
    """Return what a check asks for. module: metrics of the user."""
    if module is not None and check.name in module.metrics:
        own = judged_by_own(observed, check, module)
        return Observation(own.value, own.uncertainty, own.note)
    if check.name == "msg":
        return printed(observed, check)
    if check.axis is not None and check.axis not in observed.axes:
        return Observation(None, note=f"the rig has no axis {check.axis}")
    hidden = observed.hides(check.definition, check.axis)
    if hidden:
        return Observation(None, note=hidden, is_hidden=True)
    refused = "" if _of_no_axis(observed, check) else turned(observed, check)
    if refused:
        return Observation(None, note=refused)
    metric = check.definition
    name = metric.linear or metric.name
    function = next(topic.metrics[name] for topic in topics if name in topic.metrics)
    found = function(observed, check.axis)
    return in_newton_metres(found, observed, check) if metric.unit == TORQUE else found


def _of_no_axis(observed: Observed, check: Check) -> bool:
    """Whether a check is about the channel: lengths of its tool and of its 3D distance control."""
    if check.axis is not None:
        return False
    is_control = (
        check.definition.name in DISTANCE_METRICS and observed.facts.distance_3d is not None
    )
    return is_control or check.definition.scope == "run"


def judged(
    observed: Observed,
    checks: Sequence[Check],
    topics: Sequence[Topic] = TOPICS,
    module: OwnModule | None = None,
) -> tuple[Verdict, list[CheckResult]]:
    """Return the verdict of a run and what became of each check.

    module: metrics of the user. A check is `error` when it needs a signal that was not recorded.
    """
    found = []
    for check in checks:
        if module is not None and check.name in module.metrics:
            found.append(judged_by_own(observed, check, module))
            continue
        try:
            if isinstance(check, StatisticCheck):
                values = readings(observed, check, partial(observe, topics=topics, module=module))
                found.append(judge_statistic(check, [RunSample("", values)]))
                continue
            seen = observe(observed, check, topics)
        except MissingSignalError as error:
            found.append(CheckResult(check, None, 0.0, Verdict.ERROR, str(error)))
            continue
        found.append(
            judge(check, seen.value, seen.uncertainty, seen.note, is_hidden=seen.is_hidden)
        )
    verdicts = [result.verdict for result in found]
    return worst([*verdicts, Verdict.ABORTED] if observed.facts.is_stopped else verdicts), found


def sampled(
    observed: Observed,
    checks: Sequence[StatisticCheck],
    topics: Sequence[Topic] = TOPICS,
    module: OwnModule | None = None,
) -> Mapping[str, tuple[Reading, ...]]:
    """Return the values that a run gives to the statistics of its case, by the check's metric.

    module: metrics of the user. Those that need a signal that was not recorded are left out.
    """
    found = {}
    for check in checks:
        try:
            found[check.metric] = readings(
                observed, check, partial(observe, topics=topics, module=module)
            )
        except MissingSignalError:
            continue
    return found


def events(observed: Observed, topics: Sequence[Topic] = TOPICS) -> list[Event]:
    """Return the marks of the report in the order of time."""
    marks = [mark for topic in topics for mark in topic.events(observed)]
    marks.sort(key=lambda mark: (mark.time_ns, mark.kind, mark.label))
    # What passed at one instant stays in the order of the program
    marks += [Event(note.time_ns, "mark", note.words) for note in observed.facts.plc]
    return sorted(marks, key=lambda mark: (mark.time_ns, mark.kind))


def findings(observed: Observed, topics: Sequence[Topic] = TOPICS) -> RunFindings:
    """Return what the report shows of a run beside its checks."""
    return replace(
        of_facts(observed.facts),
        events=events(observed, topics),
        of_topics=[found for topic in topics for found in topic.findings(observed)],
    )
