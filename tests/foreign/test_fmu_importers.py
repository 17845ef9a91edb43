"""Our FMUs in importers that nobody here wrote: the numbers of our own stepping.

`AXISRIG_FMUSIM=... AXISRIG_ECOSPY=... pytest tests/foreign/test_fmu_importers.py` runs all; the
table of results is in docs/fmus.md.
"""

from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmu_importers import IMPORTERS, Task
from numpy.typing import NDArray

from axisrig.bench.tools.fmu.release import Change, courses, walk
from axisrig.fmus import FMI_VERSIONS, MODELS, ensure_built

S = 1_000_000_000
SPANS_NS = {1_000_000: S, 250_000: S, 50_000: S // 2, 370_000: S, 10_000_000: S}
"""Of each step; ten thousand of the smallest are enough."""
OF_THE_RANGE = 1e-12


@cache
def outputs_of(fmu: Path) -> tuple[tuple[str, str], ...]:
    """Scalar outputs: name and type."""
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    return tuple(
        (v.name, str(v.type)) for v in variables if v.causality == "output" and not v.dimensions
    )


def course_until(model: str, end_ns: int) -> tuple[Change, ...]:
    """What changes before an instant."""
    return tuple(change for change in courses()[model] if change.at_s * 1e9 < end_ns)


@cache
def ours(fmu: Path, model: str, step_ns: int, span_ns: int) -> NDArray[np.float64]:
    """The outputs by the stepping of the bench, a row for each communication point."""
    names, rows = walk(fmu, course_until(model, span_ns), step_ns, span_ns // step_ns)
    place = {name: number for number, name in enumerate(names)}
    return np.array(rows)[:, [place[name] for name, _ in outputs_of(fmu)]]


def test_every_model_has_a_course_that_moves_an_output() -> None:
    assert set(courses()) == set(MODELS)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("importer", IMPORTERS)
@pytest.mark.parametrize("fmi", FMI_VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_foreign_importer_gets_the_numbers_of_our_stepping(
    model: str, fmi: str, importer: str, tmp_path: Path
) -> None:
    fmu = ensure_built(model, fmi=fmi)
    chosen = IMPORTERS[importer]
    for step_ns, span_ns in SPANS_NS.items():
        course, count = course_until(model, span_ns), span_ns // step_ns
        task = Task(fmu, course, step_ns, count, outputs_of(fmu))
        expected = ours(fmu, model, step_ns, span_ns)
        expected = expected if chosen.begins else expected[1:]
        found = chosen.run(task, tmp_path)
        assert found.shape == expected.shape, (step_ns, found.shape)
        span = np.ptp(expected, axis=0)
        assert span.max() > 0.0
        allowed = OF_THE_RANGE * span
        if chosen.digits:
            allowed = allowed + np.abs(expected) * 10.0 ** (1 - chosen.digits)
        off = np.abs(found - expected) > allowed
        assert not off.any(), (step_ns, [task.outputs[k] for k in np.flatnonzero(off.any(axis=0))])
