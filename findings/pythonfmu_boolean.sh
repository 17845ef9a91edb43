#!/usr/bin/env bash
# pythonfmu 0.7.0 writes a Boolean input without a variability as continuous, and fmpy 0.3.32 refuses the FMU.
#
# The variable is registered with its causality alone, as the examples register numbers. The guess: a variable
# that is not a number becomes discrete, the only variability that FMI 2.0 allows for such an input. What
# comes: the attribute is left out, whose default is continuous, so that a strict importer does not load it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pythonfmu==0.7.0 fmpy==0.3.32 'setuptools<81'
cd "$work"
cat >gate.py <<'PYTHON'
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Real


class Gate(Fmi2Slave):
    author = "example"
    description = "passes a number while it is open"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.value, self.is_open, self.passed = 1.0, True, 0.0
        self.register_variable(Real("value", causality=Fmi2Causality.input))
        self.register_variable(Boolean("is_open", causality=Fmi2Causality.input))
        self.register_variable(Real("passed", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.passed = self.value if self.is_open else 0.0
        return True
PYTHON
venv/bin/pythonfmu build -f gate.py -d . >log 2>&1 || { cat log; exit 2; }
cat >try.py <<'PYTHON'
import fmpy

try:
    fmpy.read_model_description("Gate.fmu")
except Exception as error:
    print(type(error).__name__, "Boolean" in str(error), "continuous" in str(error))
found = fmpy.read_model_description("Gate.fmu", validate=False)
print([(v.name, v.variability) for v in found.modelVariables if v.type == "Boolean"])
PYTHON
cat >expected <<'TEXT'
ValidationError True True
[('is_open', 'continuous')]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
