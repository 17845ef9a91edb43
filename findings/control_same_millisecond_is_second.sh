#!/usr/bin/env bash
# node-pid-controller 1.0.1 (npm) counts an update in the same millisecond as the one before as a whole second, and its first one too.
#
# A controller that integrates by 1 per s, and has no step time given, so that it takes the time itself, has an error of 1: once, then without a pause for a tenth of a second, then each 20 ms for
# as long. The guess: the first update has nothing to integrate over, and the integral is the time that went by, 0.1 and 0.2, however often it was updated. What comes: 1 for the
# first, and for a loop without a pause thousands: a time that is 0 in whole milliseconds is replaced by 1 s. In a loop of less than 1 ms nearly each cycle is
# such a one, so that the integral runs a thousand times too fast and the derivative is divided by 1 s; at 20 ms it is right but for the second at the start.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >log 2>&1
npm install --no-audit --no-fund --ignore-scripts node-pid-controller@1.0.1 >log 2>&1 || { cat log; exit 2; }
cat >try.js <<'JS'
const Controller = require("node-pid-controller");

const made = (dt) => {
  const controller = new Controller({ k_p: 0, k_i: 1, k_d: 0, dt });
  controller.setTarget(1);
  return controller;
};
const clock = () => Number(process.hrtime.bigint()) / 1e9;

/** Integral beyond the time that went by, after updates for a while with a pause in between. */
const beyond = (controller, seconds, pause) => {
  const begun = clock();
  let integral = controller.update(0);
  const first = integral;
  while (clock() - begun < seconds) {
    const next = clock() + pause;
    while (clock() < next);
    integral = controller.update(0);
  }
  return { first, extra: integral - (clock() - begun) };
};

const paused = beyond(made(), 0.2, 0.02);
console.log(`first update: integral ${paused.first} s; 0.2 s with updates each 20 ms: ${paused.extra.toFixed(0)} s beyond the time`);
const busy = beyond(made(), 0.1, 0);
console.log(`0.1 s without a pause: more than 1000 s beyond the time: ${busy.extra > 1000}`);
const told = made(0.001);
let integral = 0;
for (let step = 0; step < 100; step++) integral = told.update(0);
console.log(`100 updates with a step time of 1 ms: integral ${integral.toFixed(3)} s`);
JS
cat >expected <<'TEXT'
first update: integral 1 s; 0.2 s with updates each 20 ms: 1 s beyond the time
0.1 s without a pause: more than 1000 s beyond the time: true
100 updates with a step time of 1 ms: integral 0.100 s
TEXT
node try.js 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
