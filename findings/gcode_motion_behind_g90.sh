#!/usr/bin/env bash
# gcode-toolpath 3.0.0 (npm) loses the motion of a block in which G90 or G91 stands before the axis words.
#
# A motion word holds until another of its group comes (RS274/NGC), so that after G1 the block G90 X20 goes straight to X20.
# The guess: two lines, to 5 and to 20. What comes: the line to 5 alone; the tool path, its position and what is drawn of it
# go on from 5. X20 in a block of its own, G90 G1 X20, and G90 behind the motion are read.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --ignore-scripts gcode-toolpath@3.0.0 >/dev/null
cat >try.js <<'SCRIPT'
const Toolpath = require('gcode-toolpath');
for (const block of ['G90 X20', 'G91 X15', 'X20', 'G90 G1 X20']) {
  const ends = [];
  const path = new Toolpath({ addLine: (modal, from, to) => ends.push(to.x), addArcCurve: () => {} });
  path.loadFromStringSync(['G21 G90', 'G1 X5 F100', block].join('\n'), () => {});
  console.log(`${block}: lines to ${ends.join(' and ')}, position ${path.getPosition().x}`);
}
SCRIPT
cat >expected <<'TEXT'
G90 X20: lines to 5, position 5
G91 X15: lines to 5, position 5
X20: lines to 5 and 20, position 20
G90 G1 X20: lines to 5 and 20, position 20
TEXT
node try.js >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
