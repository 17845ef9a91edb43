"""Results folders written by hand: cases that sweep one, two and three inputs, and a search."""

import re
from pathlib import Path

CASES = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.A,plc:V.E.B"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"


def folder(place: Path, rows: list[tuple[str, str, str, float, str]]) -> Path:
    """rows: case, V.E.A, V.E.B, value, verdict; the upper limit is ten times V.E.A."""
    cases, checks = [CASES], [CHECKS]
    for number, (case, a, b, value, verdict) in enumerate(rows):
        cases.append(f"p,{case},r{number},{verdict},1,1,1,,,{a},{b}")
        limit = float(a) * 10 if a.isdigit() else ""
        checks.append(f"p,{case},r{number},,m,{value},um,,{limit},0.1,{verdict},p.csv:2")
        checks.append(f"p,{case},r{number},none,alarms,,,,,0.0,pass,")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


def wide(place: Path, rows: list[tuple[tuple[str, str, str], float, str]]) -> Path:
    """A case over three inputs; rows: V.E.A, V.E.B, V.E.C, value, verdict."""
    cases, checks = [f"{CASES},plc:V.E.C"], [CHECKS]
    for number, (inputs, value, verdict) in enumerate(rows):
        cases.append(f"p,c,r{number},{verdict},1,1,1,,,{','.join(inputs)}")
        checks.append(f"p,c,r{number},,m,{value},um,,100,0.1,{verdict},p.csv:2")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


GRID = [(a, b, c) for a in ("1", "2", "3") for b in ("10", "20") for c in ("POS", "NEG")]


SEARCH = f"{CASES},search:plc:V.E.A,runs,probe"


def searched(place: Path, ends: tuple[str, str]) -> Path:
    """A row that has searched V.E.A from 100 to 500; m is V.E.A and has to be 310 at most."""
    cases, checks = [SEARCH], [CHECKS]
    for number, value in enumerate((100, 500, 300, 400, 350, 325), 1):
        verdict = "pass" if value <= 310 else "fail"
        cases.append(f"p,c,p-c-s{number:02},{verdict},1,1,1,,,{value},1,100 .. 500 to 50,,p-c")
        checks.append(f"p,c,p-c-s{number:02},<= 310,m,{value},um,,310,1,{verdict},p.csv:2")
    cases.append("p,c,p-c,pass,1,1,1,,,,1,100 .. 500 to 50,6,")
    for metric, value in zip(("search_good", "search_bad"), ends, strict=True):
        checks.append(f"p,c,p-c,,{metric},{value},,,,0,pass,p.csv:2")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


def numbers(pattern: str, text: str) -> list[tuple[float, ...]]:
    """The groups of each place that a pattern fits, as numbers."""
    return [tuple(map(float, match)) for match in re.findall(pattern, text)]
