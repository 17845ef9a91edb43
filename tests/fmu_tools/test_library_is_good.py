"""Every model of the library passes what `axisrig fmu check` tries, and repeats in a new process.

The trials run in this process: what they find does not depend on that, and processes cost time.
"""

from collections.abc import Mapping
from pathlib import Path

import pytest

from axisrig.bench.campaign.processes import run_apart
from axisrig.bench.tools.fmu import stages
from axisrig.bench.tools.fmu.examine import examine
from axisrig.bench.tools.fmu.findings import Finding, Level
from axisrig.fmus import MODELS, ensure_built

STAGES = (*stages.FIRST, *stages.REST)


def failed(findings: list[Finding]) -> list[str]:
    """What may not be."""
    return [f"{found.area}: {found.text}" for found in findings if found.level == Level.FAIL.value]


@pytest.mark.long(but=1)
@pytest.mark.parametrize("model", MODELS)
def test_model_passes_every_trial(model: str) -> None:
    path = ensure_built(model)
    examined = examine(path)
    assert failed(examined.findings) == []
    assert examined.can_run
    for stage in STAGES:
        outcome = stages.run_stage(stage, path)
        assert outcome.findings, stage
        assert failed(outcome.findings) == []


@pytest.mark.long
def test_models_do_the_same_in_a_process_with_another_memory_layout() -> None:
    paths: Mapping[str, Path] = {model: ensure_built(model) for model in MODELS}
    here = {m: stages.run_stage("determinism", path).digest for m, path in paths.items()}
    assert len(set(here.values())) == len(MODELS)
    tasks = [["determinism", path] for path in paths.values()]
    there = run_apart(stages.run_stage, tasks, is_fresh=False, is_unrelated=True)
    assert [getattr(answer, "digest", answer) for answer in there] == list(here.values())
