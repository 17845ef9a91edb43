"""Which runs `axisrig diff` calls better, worse, or neither."""

from pathlib import Path

import pytest
from tests.results.test_pairs import compared

from axisrig.bench.plan.verdict import Verdict
from axisrig.results.compare.words import diff_lines


@pytest.mark.parametrize("before", Verdict)
@pytest.mark.parametrize("after", Verdict)
def test_a_run_is_better_or_worse_by_the_rank_of_its_verdict(
    tmp_path: Path, before: Verdict, after: Verdict
) -> None:
    sides = ({"runs": [{"run": "r", "verdict": each.word}]} for each in (before, after))
    lines = list(diff_lines(compared(tmp_path, *sides)))
    words = f"r: {before.word} -> {after.word}"
    assert (f"better: {words}" in lines) is (after < before)
    assert (f"worse: {words}" in lines) is (after > before)
    assert len(lines) == 1 + (before is not after)
