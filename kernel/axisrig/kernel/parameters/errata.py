"""What the scans of the manuals made of parameter lists, and what was meant.

`errata.csv` has the damaged places of the printed sample lists. Beside it a damaged name is
recognised where blanks replace underscores, or where the value touches the name.
"""

import csv
import re
from functools import cache
from importlib import resources

from axisrig.kernel.parameters.table import Kind, Parameter, table

# What text recognition leaves of an underscore
_UNDERSCORE = r"(?:_|\\_|[ \t]|<sup>[-_\s]*(?:</sup>)?[-_]?)"


@cache
def errata() -> tuple[tuple[str, str, str], ...]:
    """Return (printed, meant, source) of `errata.csv`, the longest first; lines end with \\n."""
    text = resources.files(__package__).joinpath("errata.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines(keepends=True))
    found = [(row["printed"], row["meant"], row["source"]) for row in rows]
    return tuple(sorted(found, key=lambda row: -len(row[0])))


def _squeezed(text: str) -> str:
    return "\n".join(" ".join(line.split()) for line in text.splitlines())


def meant(text: str) -> str:
    """Return a printed list as it was meant: every place of `errata.csv` replaced."""
    text = f"\n{_squeezed(text)}\n"
    for printed, right, _ in errata():
        text = text.replace(f"\n{_squeezed(printed)}\n", f"\n{right}\n")
    return text[1:]


@cache
def _damaged(kind: Kind) -> re.Pattern[str]:
    """Match every name of a kind as a scan may have left it."""
    paths = sorted(set(table(kind).paths()), key=len, reverse=True)
    forms = []
    for path in paths:
        form = re.escape(path).replace("_", _UNDERSCORE)
        forms.append(form.replace(re.escape("[0]"), r"\[\s*[0-9]{1,4}\s*\]"))
    return re.compile("|".join(forms), re.IGNORECASE)


@cache
def _squashed(kind: Kind) -> dict[str, str]:
    return {_bare(path): path for path in table(kind).paths()}


def _bare(name: str) -> str:
    # Indices first: blanks in their brackets are no underscores
    return re.sub(_UNDERSCORE, "_", re.sub(r"\[\s*[0-9]+\s*\]", "[0]", name.lower()))


def damaged_name(line: str, kind: Kind) -> str | None:
    """Return a hint naming what a line with a damaged name means, None if it looks like nothing."""
    text = re.split("[#;]", line, maxsplit=1)[0].strip()
    readings = _readings(text[:2000], kind)
    if not readings:
        return None
    return "it means " + " and ".join(readings)


def _readings(text: str, kind: Kind) -> list[str]:
    matches = list(_damaged(kind).finditer(text))
    if not matches or matches[0].start():
        return []
    ends = [match.start() for match in matches[1:]] + [len(text)]
    readings = []
    for match, end in zip(matches, ends, strict=True):
        name = _squashed(kind)[_bare(match[0])]
        name = _indexed(name, re.findall(r"\[\s*([0-9]+)\s*\]", match[0]))
        row = table(kind).row(name)
        value = text[match.end() : end].strip()
        readings.append(f"{name} {_joined(value, row)}".strip())
    return readings


def _indexed(name: str, indices: list[str]) -> str:
    """Put indices in place of the 0 of each bracket."""
    parts = name.split("[0]")
    return "".join(
        part + (f"[{indices[at]}]" if at < len(indices) else "") for at, part in enumerate(parts)
    )


def _joined(value: str, row: Parameter | None) -> str:
    if row is None or row.type != "STRING":
        return value
    return re.sub(r"\\?_|[ \t]+", "_", value)


def damaged_value(value: str, row: Parameter | None) -> str | None:
    """Return a hint for a STRING that is written in several words."""
    if row is None or row.type != "STRING":
        return None
    joined = _joined(value.strip(), row)
    if row.values and joined not in row.values:
        return None
    return f"it means {joined}" if row.values else f"{joined}, or the text in quotes"
