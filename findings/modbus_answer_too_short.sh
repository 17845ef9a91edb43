#!/usr/bin/env bash
# jsmodbus 5.0.0 (npm) has a server that answers a read beyond its last register with fewer values, and a client that takes them.
#
# A server has 100 holding registers with 1000 to 1099 and 32 coils; the first ones, the last one, and four from the last but one on are read, and one behind the last. The guess: what
# is not there is refused by exception 2, illegal data address, a count of 0 or of 126 by exception 3 (Modbus application protocol 1.1b3, 6.1 and 6.3: the number of bytes is twice the
# quantity asked for). What comes: two values for four, none for one, all 100 for 126, and no exception. The client does not compare the answer with what it asked for: a position in two
# registers, the second of which is not there, is one value. Four coils are eight values, whole bytes, so that those that are not there look like those that are off.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >log 2>&1
npm install --no-audit --no-fund --ignore-scripts jsmodbus@5.0.0 >log 2>&1 || { cat log; exit 2; }
cat >try.js <<'JS'
const modbus = require("jsmodbus");
const net = require("net");

const holding = Buffer.alloc(200);
for (let register = 0; register < 100; register++) holding.writeUInt16BE(1000 + register, 2 * register);
const listening = new net.Server();
new modbus.server.TCP(listening, { holding, coils: Buffer.alloc(4, 0xff), input: Buffer.alloc(2), discrete: Buffer.alloc(2) });

listening.listen(0, "127.0.0.1", () => {
  const socket = new net.Socket();
  const client = new modbus.client.TCP(socket, 1);
  const read = async (what, address, count) => {
    try {
      const { body } = (await client[what](address, count)).response;
      const values = body.valuesAsArray;
      const shown = values.length > 8 ? `${values[0]} to ${values[values.length - 1]}` : values.join(" ");
      console.log(`${what}, ${count} from ${address}: ${values.length} values ${shown}`.trim());
    } catch (error) {
      console.log(`${what}, ${count} from ${address}: refused, ${error.message || error.err}`);
    }
  };
  socket.on("connect", async () => {
    for (const [address, count] of [[0, 2], [99, 1], [98, 4], [99, 2], [100, 1], [0, 0], [0, 126]]) await read("readHoldingRegisters", address, count);
    for (const [address, count] of [[28, 4], [30, 4], [32, 8]]) await read("readCoils", address, count);
    socket.end();
    listening.close();
  });
  socket.connect(listening.address().port, "127.0.0.1");
});
JS
cat >expected <<'TEXT'
readHoldingRegisters, 2 from 0: 2 values 1000 1001
readHoldingRegisters, 1 from 99: 1 values 1099
readHoldingRegisters, 4 from 98: 2 values 1098 1099
readHoldingRegisters, 2 from 99: 1 values 1099
readHoldingRegisters, 1 from 100: 0 values
readHoldingRegisters, 0 from 0: 0 values
readHoldingRegisters, 126 from 0: 100 values 1000 to 1099
readCoils, 4 from 28: 8 values 1 1 1 1 0 0 0 0
readCoils, 4 from 30: 8 values 1 1 0 0 0 0 0 0
readCoils, 8 from 32: 0 values
TEXT
node try.js 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
