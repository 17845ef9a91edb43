#!/usr/bin/env bash
# pyhoff 1.1.2 reads another channel of a Beckhoff terminal if the terminals are named where the coupler is made, as its own example does.
#
# A coupler BK9000 has two resistance thermometers of 23.2 and 41.7 degrees (KL3202) and two outputs of 10 V (KL4002). The guess: the terminals are given to the coupler at once or
# added afterwards, and the same is read and written; the package describes both ways. What comes: added afterwards, both temperatures are right and the outputs go to the words
# 0x805 and 0x807, behind the start of the outputs at 0x800 (Beckhoff, BK9000, Modbus interface, process image). Given at once, channel 1 shows the status word of the terminal
# as 0.0 degrees, channel 2 the temperature of channel 1, and the outputs are sent to the words 2 and 3, where the inputs are: the places are counted before
# it is known where the outputs begin. And `read_delta` of a counter (KL1512), which is to give the change since its last call, gives that since the start.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyhoff==1.1.2
cd "$work"
cat >try.py <<'PYTHON'
import socket
import struct
import threading

from pyhoff.devices import BK9000, KL1512, KL3202, KL4002


class Coupler:
    """A coupler of words: each channel has a status and a value."""

    def __init__(self, words):
        self.words, self.written = words, []
        self.socket = socket.create_server(("127.0.0.1", 0))
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        connection, _ = self.socket.accept()
        while request := connection.recv(260):
            transaction, _, _, unit, function, address, value = struct.unpack(">HHHBBHH", request[:12])
            if function == 4:
                answer = bytes([function, 2 * value]) + b"".join(struct.pack(">H", self.words.get(address + word, 0)) for word in range(value))
            else:
                self.written.append((address, value))
                answer = request[7:12]
            connection.sendall(struct.pack(">HHHB", transaction, 0, len(answer) + 1, unit) + answer)


def coupler(words, terminals, at_once):
    device = Coupler(words)
    where = ("127.0.0.1", device.socket.getsockname()[1])
    if at_once:
        return device, BK9000(*where, bus_terminals=terminals)
    used = BK9000(*where)
    used.add_bus_terminals(*terminals)
    return device, used


for at_once in (False, True):
    device, used = coupler({1: 232, 3: 417}, [KL3202, KL4002], at_once)
    degrees = [used.select(KL3202).read_temperature(channel) for channel in (1, 2)]
    for channel, volts in ((1, 5.0), (2, 2.5)):
        used.select(KL4002).set_voltage(channel, volts)
    places = [f"{address:#x}" for address, value in device.written if address < 0x1000]
    print("given at once:" if at_once else "added afterwards:", degrees, "degrees, outputs to", places)
device, used = coupler({1: 1000}, [KL1512], False)
deltas = []
for device.words[1] in (1010, 1015, 1015):
    deltas.append(used.select(KL1512).read_delta(1))
print("counter 1000, 1010, 1015, 1015: deltas", deltas)
PYTHON
cat >expected <<'TEXT'
added afterwards: [23.2, 41.7] degrees, outputs to ['0x805', '0x807']
given at once: [0.0, 23.2] degrees, outputs to ['0x2', '0x3']
counter 1000, 1010, 1015, 1015: deltas [10, 15, 15]
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
