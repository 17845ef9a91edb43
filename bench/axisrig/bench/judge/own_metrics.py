"""Metrics of the user, called with a recording (`axisrig.bench.plan.own_metrics`)."""

import traceback
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from hashlib import sha256
from importlib import metadata
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import Any

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.plan.checks import Check, CheckResult, judge
from axisrig.bench.plan.own_metrics import GROUP, PREFIX, OwnModule
from axisrig.bench.plan.verdict import Verdict

_FORM = "value, unit, uncertainty"
_PARTS = len(_FORM.split(","))


def judged_by_own(observed: Observed, check: Check, module: OwnModule) -> CheckResult:
    """Call `metric_<name>(recording)` and judge what it returns.

    The function returns the value (a number, a text or None), its unit, and its expanded
    uncertainty in this unit. What it raises, and a result of another form, is `error` with the
    place in the file.
    """
    try:
        value, unit, uncertainty = _parts(_function(module, check.name)(observed))
    except (Exception, SystemExit) as error:  # whatever the code of somebody else raises
        return CheckResult(check, None, 0.0, Verdict.ERROR, _words(error, module))
    named = replace(check, defined=replace(check.definition, unit=unit))
    return judge(named, value, uncertainty, f"{PREFIX}{check.name} of {module.name}")


def _parts(result: object) -> tuple[Any, str, float]:
    if not isinstance(result, tuple) or len(result) != _PARTS:
        raise TypeError(f"it returns {result!r}, not {_FORM}")
    value, unit, uncertainty = result
    if not (value is None or isinstance(value, Real | str)):
        raise TypeError(f"the value is {value!r}: a number, a text or None is expected")
    if not isinstance(unit, str):
        raise TypeError(f"the unit is {unit!r}: a text is expected")
    if not isinstance(uncertainty, Real) or not float(uncertainty) >= 0.0:
        raise TypeError(f"the uncertainty is {uncertainty!r}: a number, 0 or more, is expected")
    if isinstance(value, Real) and not isinstance(value, int):
        value = float(value)  # also a scalar of numpy
    return value, unit, float(uncertainty)


def _function(module: OwnModule, name: str) -> Any:
    if module.path is None:
        found = metadata.entry_points(group=GROUP)[module.name].load()
        return getattr(found, f"{PREFIX}{name}")
    content = module.path.read_bytes()
    return _loaded(module.path, sha256(content).hexdigest())[f"{PREFIX}{name}"]


@lru_cache(maxsize=16)
def _loaded(path: Path, _content: str) -> Mapping[str, Any]:
    """Run a file once for each content; its functions share the module."""
    module = ModuleType(path.stem)
    module.__file__ = str(path)
    exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
    return vars(module)


def _words(error: BaseException, module: OwnModule) -> str:
    """Say what a metric raised, with the last line of the user's file that led to it."""
    own = str(module.path)
    frames = traceback.extract_tb(error.__traceback__)
    line = next((frame.lineno for frame in reversed(frames) if frame.filename == own), None)
    place = module.name if line is None else f"{module.name}:{line}"
    return f"{place}: {type(error).__name__}: {error}"
