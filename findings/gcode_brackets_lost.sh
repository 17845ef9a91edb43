#!/usr/bin/env bash
# p2g 0.3.10 loses brackets behind a minus and behind a slash when it makes a program with variables out of Python.
#
# p2g translates Python to blocks with #-variables, for probing and for work offsets on a machine. The guess: a difference of a sum and a quotient
# of a product keep their brackets, since operators of one rank are taken from the left (macro B, RS274/NGC, and Python too). What comes:
# x - (y + z) becomes #100 - #101 + #102, and x / (y * z) becomes #100 / #101 * #102: with 10, 3 and 2 the machine gets 9 instead of 5 and 6.667
# instead of 1.667. Brackets that a product needs are kept. `not x` becomes the opposite of what it is.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check p2g==0.3.10
cd "$work"
cat >try.py <<'PYTHON'
import re
import subprocess

VALUES = {"x": 10.0, "y": 3.0, "z": 2.0}
PLACES = {"#100": 10.0, "#101": 3.0, "#102": 2.0}
for formula in ("(x - y) * z", "x - (y + z)", "x - (y - z)", "x / (y * z)", "not x"):
    variables = "".join(f"    {name} = Var({value})\n" for name, value in VALUES.items())
    with open("offset.py", "w") as file:
        file.write(f"from p2g import *\ndef offset():\n{variables}    w = Var({formula})\n")
    made = subprocess.run(
        ["venv/bin/p2g", "--func=offset", "offset.py", "-"], check=True, capture_output=True, text=True
    ).stdout
    (block,) = re.findall(r"#103= (.*?) +\(", made)
    meaning = re.sub(r"#\d+", lambda place: str(PLACES[place[0]]), block.replace("NE", "!="))
    meant, got = float(eval(formula, {}, VALUES)), float(eval(meaning.replace("[", "(").replace("]", ")")))
    print(f"{formula} -> {block}: {got:.3f}, in Python {meant:.3f}")
PYTHON
cat >expected <<'TEXT'
(x - y) * z -> [#100 - #101] * #102: 14.000, in Python 14.000
x - (y + z) -> #100 - #101 + #102: 9.000, in Python 5.000
x - (y - z) -> #100 - #101 - #102: 5.000, in Python 9.000
x / (y * z) -> #100 / #101 * #102: 6.667, in Python 1.667
not x -> #100 NE 0.: 1.000, in Python 0.000
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
