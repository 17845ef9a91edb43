#!/usr/bin/env bash
# gcode-toolpath 3.0.0 (npm) adds the zero shift of X to the Z axis of an arc in the plane G18.
#
# G92 X-100 at 0 shifts the programmed zero, so that X10 is 110 in front of the machine (RS274/NGC, G92). The guess: a line and the half circle
# behind it have the same shift. What comes: an arc is passed on in the axes of its plane, Z X Y in G18, and the shift is added only then, as X Y Z:
# the line ends at X110, and the arc begins at X10 with its Z moved by 100. In G17 both have it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts gcode-toolpath@3.0.0 >/dev/null
cat >try.js <<'SCRIPT'
const Toolpath = require('gcode-toolpath');
const axes = { G17: ['x', 'y', 'z'], G18: ['y', 'z', 'x'] };
for (const [plane, arc] of [['G17', 'G2 X20 I5'], ['G18', 'G2 X20 I5']]) {
  for (const shift of ['', 'G92 X-100']) {
    const ends = [];
    const path = new Toolpath({
      addLine: (modal, from, to) => ends.push(`line to X${to.x} Z${to.z}`),
      addArcCurve: (modal, from) => {
        const [x, , z] = axes[modal.plane].map((name) => from[name]);
        ends.push(`arc from X${x} Z${z}`);
      },
    });
    path.loadFromStringSync(['G21 G90', plane, shift, 'G1 X10 F100', arc].join('\n'), () => {});
    console.log(`${plane} ${shift || 'no shift'}: ${ends.join(', ')}`);
  }
}
SCRIPT
cat >expected <<'TEXT'
G17 no shift: line to X10 Z0, arc from X10 Z0
G17 G92 X-100: line to X110 Z0, arc from X110 Z0
G18 no shift: line to X10 Z0, arc from X10 Z0
G18 G92 X-100: line to X110 Z0, arc from X10 Z100
TEXT
node try.js >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
