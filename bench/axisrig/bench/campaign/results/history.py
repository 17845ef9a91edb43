"""What the manifest says about the calls of `axisrig run` that a results folder comes from.

Its head is the last call; `earlier` holds the heads of calls before it that still have rows, with
the ids of these `runs`; `missing` the ids of planned runs that have been asked for and have no row.
"""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from axisrig.bench.campaign.results.stored import IN_PLAN, PROBE, read_manifest
from axisrig.bench.files import sha256_of
from axisrig.bench.plan.plan import Plan
from axisrig.kernel.errors import UserError

_OF_THE_FOLDER = ("earlier", "missing", "runs_planned", "finished", "drive_substituted")


def refuse_other_plans(folder: Path, plans: Sequence[Plan]) -> None:
    """Raise UserError where a folder holds results of other plans than these.

    Some of its plans are a part of it; all of them, and more, make it larger.
    """
    kept = {entry["name"]: entry for entry in read_manifest(folder).get("plans", [])}
    others = kept.keys() - {plan.name for plan in plans}
    for plan in plans:
        entry = kept.get(plan.name)
        is_other = bool(others) if entry is None else not _is_same(entry, plan)
        if kept and is_other:
            raise UserError(
                "the folder holds results of another plan",
                file=folder,
                value=str(plan.path),
                allowed=[entry["path"] for entry in kept.values()],
                hint="name another folder with -o, or clear this one with --fresh",
            )


def _is_same(entry: Mapping[str, str], plan: Plan) -> bool:
    """Whether an entry of a manifest is this plan, or was made from equal bytes elsewhere."""
    return Path(entry["path"]).resolve() == plan.path.resolve() or entry["sha256"] == sha256_of(
        plan.path
    )


class History:
    """The runs that a folder has and should have, by the calls that made it."""

    def __init__(
        self, folder: Path, plans: Sequence[Plan], head: Mapping[str, Any], runs: Collection[str]
    ) -> None:
        """Read what the folder says of itself; head: of this call. runs: ids of those it runs."""
        old = read_manifest(folder)
        entries = {entry["name"]: entry for entry in old.get("plans", [])}
        self._plans = {plan.name for plan in plans}
        self.is_whole = entries.keys() <= self._plans
        entries |= {entry["name"]: entry for entry in head.get("plans", [])}
        self._head = {**head, **({"plans": list(entries.values())} if entries else {})}
        names = dict.fromkeys([*entries, *(plan.name for plan in plans)])
        self._folder_plans = {name: place for place, name in enumerate(names)}
        self._order = {
            case.run: (case.plan, place) for plan in plans for place, case in enumerate(plan.rows)
        }
        self._runs = set(runs)
        # run -> plan, of all that have been asked for
        self._asked = {run: name for name, ids in old.get("missing", {}).items() for run in ids}
        self._asked |= {run: place[0] for run, place in self._order.items() if run in self._runs}
        self._earlier = [dict(entry) for entry in old.get("earlier", [])]
        if old:
            self._earlier.append({k: v for k, v in old.items() if k not in _OF_THE_FOLDER})

    @property
    def asked(self) -> Collection[str]:
        """Ids of all runs that this or an earlier call was to run."""
        return self._asked

    def found(self, cases: Mapping[str, Mapping[str, str]]) -> None:
        """Take in the rows that the folder has."""
        self._asked |= {run: row["plan"] for run, row in cases.items() if not row.get(PROBE)}
        known = {run for entry in self._earlier for run in entry.get("runs", ())}
        if self._earlier and "runs" not in self._earlier[-1]:
            self._earlier[-1]["runs"] = [
                run for run, row in cases.items() if run not in known and not row.get(PROBE)
            ]

    def note(self, entries: Mapping[str, Any]) -> None:
        """Take more entries of the manifest of this call."""
        self._head |= entries

    def replaced(self, run: str) -> bool:
        """Take away the row of an earlier call; say whether there was one."""
        for entry in self._earlier:
            if run in entry["runs"]:
                entry["runs"].remove(run)
                return True
        return False

    def is_in_plan(self, run: str, plan: str, mark: str) -> bool:
        """Whether the plan has a run; of a plan that is not called, what its row says."""
        return run in self._order if plan in self._plans else not mark

    def place(self, row: Mapping[str, str]) -> tuple[bool, int, int, str]:
        """Return where a row belongs: by plan and case, those that the plan has no more at last.

        A probe comes after the row that searches.
        """
        run, plan = row.get(PROBE) or row["run"], row["plan"]
        if not self.is_in_plan(run, plan, row.get(IN_PLAN, "")):
            return (True, 0, 0, "")
        place = self._order[run][1] if run in self._order else 0
        probe = row["run"] if row.get(PROBE) else ""
        return (False, self._folder_plans.get(plan, len(self._folder_plans)), place, probe)

    def manifest(
        self, cases: Mapping[str, Mapping[str, str]], written: Collection[str]
    ) -> dict[str, Any]:
        """Return the manifest for the rows that are there; written: runs of this call."""
        planned = [
            run
            for run, plan in self._asked.items()
            if self.is_in_plan(run, plan, cases.get(run, {}).get(IN_PLAN, ""))
        ]
        missing: dict[str, list[str]] = {}
        for run in planned:
            if run not in cases:
                missing.setdefault(self._asked[run], []).append(run)
        earlier = [entry for entry in self._earlier if entry.get("runs")]
        return {
            **self._head,
            **({"earlier": earlier} if earlier else {}),
            **({"missing": missing} if missing else {}),
            "runs_planned": len(planned),
            "finished": not missing and self._runs <= set(written),
        }
