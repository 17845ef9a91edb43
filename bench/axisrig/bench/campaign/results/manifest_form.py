"""The form of `manifest.json`, so that everything that reads an entry can rely on its type."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from axisrig.bench.campaign.results.layout import JUDGED

UPWARDS = "../.."
"""From verdicts in `judged/<n>-<plan>` to the folder with their recordings."""

Fits = Callable[[Any], bool]


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and "\x00" not in value


def _is_text_or_nothing(value: Any) -> bool:
    return value is None or _is_text(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _is_seconds(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and 0.0 <= value < math.inf


def _is_texts(value: Any) -> bool:
    return isinstance(value, list) and all(_is_text(item) for item in value)


def _is_words(value: Any) -> bool:
    return isinstance(value, dict) and _is_texts(list(value.values()))


def _is_plans(value: Any) -> bool:
    keys = ("name", "path", "sha256")
    return isinstance(value, list) and all(
        isinstance(plan, dict) and all(_is_text(plan.get(key)) for key in keys) for plan in value
    )


def _are_calls(value: Any) -> bool:
    keys = ("command", "runs")
    return isinstance(value, list) and all(
        isinstance(call, dict)
        and all(_is_texts(call.get(key, [])) for key in keys)
        and _is_text_or_nothing(call.get("started"))
        for call in value
    )


def _is_missing(value: Any) -> bool:
    return isinstance(value, dict) and all(_is_texts(runs) for runs in value.values())


_ENTRIES: Mapping[str, tuple[Fits, str]] = {
    "runs_planned": (_is_count, "whole number"),
    "plans": (_is_plans, "list of plans with name, path and sha256"),
    "earlier": (_are_calls, "list of calls with their command and runs"),
    "command": (_is_texts, "list of words"),
    "runs": (_is_texts, "list of run ids"),
    "missing": (_is_missing, "table of lists of runs"),
    "finished": (lambda value: isinstance(value, bool), "yes or no"),
    "files": (_is_words, "table of hashes"),
    "fmus": (_is_words, "table of hashes"),
    "drive_substituted": (_is_words, "table of texts"),
    "packages": (lambda value: isinstance(value, dict), "table"),
    "sources_sha256": (_is_text, "text"),
    "output": (_is_text, "text"),
    "started": (_is_text_or_nothing, "text"),
    "spent_s": (_is_seconds, "time in s"),
    "jobs": (_is_count, "whole number"),
    "axisrig": (_is_text_or_nothing, "text"),
    "python": (_is_text, "text"),
    "platform": (_is_text, "text"),
    "warnings": (_is_texts, "list of texts"),
    "merged": (_is_texts, "list of folders"),
    "recorded_in": (_is_text, "text"),
    "recordings": (lambda value: value == UPWARDS, f"{UPWARDS}, as {JUDGED}/<n>-<plan> has it"),
}
"""Entry -> what fits, and how that is called."""


def wrong_entry(manifest: Mapping[str, Any]) -> str | None:
    """Say which entry has another form than `axisrig run` writes; None where all are right."""
    for name, (fits, what) in _ENTRIES.items():
        if name in manifest and not fits(manifest[name]):
            return f"{name} is no {what}"
    return None
