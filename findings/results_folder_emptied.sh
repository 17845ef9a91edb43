#!/usr/bin/env bash
# cofmupy 1.0.0 deletes every file beside its results file before a simulation begins.
#
# The results of a co-simulation go to rows.csv in a folder that already holds a measurement, with `overwrite` as it is
# by default. The guess: rows.csv is written anew and the other file stays. What comes: the folder is emptied first, so that the
# measurement is gone.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check cofmupy==1.0.0 pythonfmu==0.6.3 'setuptools<81'
cd "$work"
cat >still.py <<'PYTHON'
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Still(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.position = 1.0
        self.register_variable(Real("position", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        return True
PYTHON
venv/bin/pythonfmu build -f still.py >log 2>&1 || { cat log; exit 2; }
mkdir results
echo 'position' >results/measured.csv
cat >system.json <<'JSON'
{"fmus": [{"id": "still", "path": "Still.fmu", "name": "Still"}], "connections": [],
 "data_storages": [{"name": "rows", "type": "file", "config": {"path": "results/rows.csv"}}]}
JSON
cat >try.py <<'PYTHON'
from cofmupy import Coordinator

Coordinator().start("system.json")
PYTHON
echo "before: $(ls results)" >seen
venv/bin/python try.py >log 2>&1 || { cat log; exit 2; }
echo "after: $(ls results)" >>seen
cat >expected <<'TEXT'
before: measured.csv
after: rows.csv
TEXT
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
