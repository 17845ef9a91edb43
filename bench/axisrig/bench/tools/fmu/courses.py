"""The course of outputs must not depend on how long the steps are in which it is asked for."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from fmpy.model_description import ModelVariable

from axisrig.bench.tools.fmu.findings import Finding, fail, ok, warn
from axisrig.bench.tools.fmu.stepped_instance import FLAG_AFTER_STEPS, Reading, Trial
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

COURSE_STEPS_NS: Final[tuple[TimeNs, ...]] = (1_000_000, 250_000, 50_000)
SPAN_NS: Final[TimeNs] = 20_000_000
# Of the range of an output: more is a method that follows its steps, which a run would show
DEVIATION: Final = 1e-3
# So often an output must have changed before it may be called held
CHANGES_MIN: Final = 4


def course_findings(path: Path, inner_ns: TimeNs) -> list[Finding]:
    """Compare the courses of an FMU in steps of 1, 0.25 and 0.05 ms over 20 ms.

    inner_ns: step that its description names, 0 for none: shorter ones show nothing new then.
    """
    courses: dict[TimeNs, list[Reading]] = {}
    outputs: Sequence[ModelVariable] = ()
    for step_ns in COURSE_STEPS_NS:
        try:
            with closing(Trial(path, moves=True)) as trial:
                outputs = trial.outputs
                trial.start()
                courses[step_ns] = trial.course(step_ns, SPAN_NS)
        except (PlantError, UserError):
            continue  # that it refuses such steps is a finding of its own
    if len(courses) < 2 or inner_ns > COURSE_STEPS_NS[1]:
        return []
    held_ns = _held_ns(path)
    if held_ns:
        text = f"its outputs stand still for steps below {held_ns / 1e6:g} ms"
        remedy = (
            "an edge is not searched between: export it with a shorter inner step, or name it as"
            " fixedInternalStepSize"
        )
        return [fail("steps", text, remedy)]
    differing = list(_differing(courses, outputs))
    if differing:
        name, step_ns, share = max(differing, key=lambda item: item[2])
        text = (
            f"the course depends on the steps: {name} differs by {share:.1%} of its range between"
            f" steps of 1 ms and {step_ns / 1e6:g} ms"
        )
        return [warn("steps", text, "results depend on exchange_us and fine_us")]
    return [ok("steps", "courses in steps of 1, 0.25 and 0.05 ms agree")]


def _numbers(
    course: Sequence[Reading], outputs: Sequence[ModelVariable]
) -> Iterator[tuple[str, list[float]]]:
    """Name and course of each element of outputs that are continuous real numbers."""
    for place, variable in enumerate(outputs):
        kinds = {str(variable.type), variable.variability or "continuous"}
        if not course or kinds - {"Real", "Float64", "Float32", "continuous"}:
            continue
        for element in range(len(course[0].values[place])):
            values: list[Any] = [reading.values[place][element] for reading in course]
            name = variable.name if len(course[0].values[place]) == 1 else f"{variable.name}[..]"
            yield name, [float(value) for value in values]


def _held_ns(path: Path) -> TimeNs:
    """How long all outputs that move stand still while inputs move in every step; 0 = they do not.

    Some may: what a digital controller gives out. All of them are those of an FMU that steps inside
    more coarsely: what moves in 1 ms moves in 0.25 ms too.
    """
    step_ns, course = COURSE_STEPS_NS[-1], list[Reading]()
    per_ms = COURSE_STEPS_NS[0] // step_ns
    try:
        # Without a drift who looks now and then may find the value of before
        with closing(Trial(path, moves=True, drifts=True)) as trial:
            trial.start()
            outputs = trial.outputs
            for place in range(SPAN_NS // step_ns):
                # Not in step with whole milliseconds: who looks at them only sees inputs move too
                trial.count = FLAG_AFTER_STEPS + place + place // per_ms
                course.append(trial.step(step_ns))
    except (PlantError, UserError):
        return 0
    held: list[int] = []
    for _, values in _numbers(course, outputs):
        changes = [place for place, (a, b) in enumerate(pairwise(values)) if a != b]
        if len(changes) >= CHANGES_MIN:
            held.append(max(b - a for a, b in pairwise(changes)))
    longest_ns = min(held, default=0) * step_ns
    return longest_ns if longest_ns > COURSE_STEPS_NS[1] else 0


def _differing(
    courses: dict[TimeNs, list[Reading]], outputs: Sequence[ModelVariable]
) -> Iterator[tuple[str, TimeNs, float]]:
    """Outputs that differ at common instants, the step, and by which share of their range."""
    longest = max(courses)
    whole = dict(_numbers(courses[longest], outputs))
    for step_ns, course in courses.items():
        if step_ns == longest:
            continue
        for name, values in _numbers(course[:: longest // step_ns], outputs):
            pairs = list(zip(whole[name], values, strict=False))
            both = [value for pair in pairs for value in pair]
            span = max(both) - min(both)
            share = max((abs(a - b) for a, b in pairs), default=0.0) / span if span else 0.0
            if share > DEVIATION:
                yield name, step_ns, share
