"""A log of scenarios: a JSON line for each that has run, so that a campaign goes on where it ended.

{"machine": "gantry", "seed": 1, "number": 0, "result": "ALARM", "alarms": [900006], "right": 0,
 "broken": [], "note": "", "frames": "..."}
"""

import json
from collections.abc import Iterator
from pathlib import Path

from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario, make_scenario
from axisrig.kernel.errors import UserError

Entry = tuple[Scenario, Judgement]


def line_of(seed: int, scenario: Scenario, judgement: Judgement) -> str:
    """Return the line of a scenario."""
    found = {
        "machine": scenario.machine,
        "seed": seed,
        "number": scenario.number,
        "result": judgement.result.name,
        "alarms": judgement.alarms,
        "right": judgement.right,
        "broken": judgement.broken,
        "note": judgement.note,
        "frames": judgement.frames,
    }
    return json.dumps(found) + "\n"


class ScenarioLog:
    """The log of a campaign. seed: of it; what the file has of other seeds stays there.

    A last line that was not written to its end is dropped. Raises UserError with file and line for
    one that cannot be read, OSError where the file cannot be.
    """

    def __init__(self, path: Path, seed: int) -> None:
        self._path, self._seed = path, seed
        self.entries: list[Entry] = []
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        whole = text[: text.rfind("\n") + 1]
        if whole != text:
            path.write_text(whole, encoding="utf-8")
        for number, line in enumerate(whole.splitlines(), 1):
            found = self._read(line, number)
            if found is not None:
                self.entries.append(found)

    def _read(self, line: str, number: int) -> Entry | None:
        try:
            found = json.loads(line)
            if found["seed"] != self._seed or found["machine"] not in machines():
                return None
            scenario = make_scenario(self._seed, found["number"], found["machine"])
            judgement = Judgement(
                Result[found["result"]],
                list(found["alarms"]),
                found["right"],
                found["note"],
                tuple(found["broken"]),
                found["frames"],
            )
        except (ValueError, KeyError, TypeError) as error:
            raise UserError(
                "no line of a log of scenarios",
                file=self._path,
                line=number,
                value=line[:60],
                hint="name a file that is not there yet, or one that axisrig scenarios has written",
            ) from error
        return scenario, judgement

    def first_of(self, machine: str) -> int:
        """Return the number of the first scenario of a machine that has not run."""
        numbers = [s.number for s, _ in self.entries if s.machine == machine]
        return max(numbers, default=-1) + 1

    def add(self, scenario: Scenario, judgement: Judgement) -> None:
        """Write a scenario that has run. Raises OSError."""
        self.entries.append((scenario, judgement))
        with self._path.open("a", encoding="utf-8") as file:
            file.write(line_of(self._seed, scenario, judgement))

    def of(self, machine: str) -> Iterator[Entry]:
        """Yield what has run of a machine."""
        return (entry for entry in self.entries if entry[0].machine == machine)
