"""What is tested, in every row of a plan: `[info]` of the rig of the row, and what a call says."""

from collections.abc import Mapping
from functools import cache

from axisrig.bench.plan.info import with_info
from axisrig.bench.plan.plan import Plan
from axisrig.bench.rig.reading.sources import info_of_rig


def with_tested(plan: Plan, said: Mapping[str, str] | None = None) -> Plan:
    """Return a plan whose rows say what is tested. said: `--info` of the call, over the rigs."""
    of_rig = cache(info_of_rig)
    return plan.with_cases(lambda case: with_info(case, {**of_rig(case.rig), **(said or {})}))
