#!/usr/bin/env bash
# asyncua 2.1.0 does not report an axis that moves away by small steps, if a client asked for changes beyond a deadband.
#
# A client watches two positions of a server with an absolute deadband of 0.1 mm; one moves in steps of 0.12 mm, the other in steps of 0.06 mm. The
# guess: the first is reported at each step, the second at each second step, since the band lies around the value that was last put into
# the queue (OPC UA part 4, 7.22.2, last cached value). What comes: the second is reported at its start and never again, though it ends
# 0.6 mm further; the server compares each value with the one before it, reported or not.
#
# Server and client are both asyncua, on 127.0.0.1.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check asyncua==2.1.0
cd "$work"
cat >try.py <<'PYTHON'
import asyncio
import socket
from asyncua import Client, Server, ua

STEPS_MM = {"steps of 0.12 mm": 0.12, "steps of 0.06 mm": 0.06}


class Reports:
    def __init__(self, names):
        self.names, self.values = names, {name: [] for name in STEPS_MM}

    def datachange_notification(self, node, value, data):
        self.values[self.names[node]].append(f"{value:.2f}")


async def main():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"opc.tcp://127.0.0.1:{free.getsockname()[1]}/"
    server = Server()
    await server.init()
    server.set_endpoint(address)
    server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
    space = await server.register_namespace("urn:axes")
    axes = {name: await server.nodes.objects.add_variable(space, name, 0.0) for name in STEPS_MM}
    async with server, Client(address) as client:
        watched = {client.get_node(axis.nodeid): name for name, axis in axes.items()}
        reports = Reports(watched)
        subscription = await client.create_subscription(20, reports)
        for node in watched:
            await subscription.deadband_monitor(node, 0.1)
        for step in range(11):
            for name in reversed(STEPS_MM):
                await axes[name].write_value(step * STEPS_MM[name])
            for _ in range(500):
                if len(reports.values["steps of 0.12 mm"]) > step:
                    break
                await asyncio.sleep(0.02)
        await asyncio.sleep(0.5)
        for node, name in watched.items():
            print(f"{name}: {await node.read_value():.2f} at the end, reported", *reports.values[name])


asyncio.run(main())
PYTHON
cat >expected <<'TEXT'
steps of 0.12 mm: 1.20 at the end, reported 0.00 0.12 0.24 0.36 0.48 0.60 0.72 0.84 0.96 1.08 1.20
steps of 0.06 mm: 0.60 at the end, reported 0.00
TEXT
venv/bin/python try.py 2>log | { grep '^steps' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
