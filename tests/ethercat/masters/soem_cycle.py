"""The cycle of SOEM (pysoem) with a drive, and its ways into OP and out of it."""

import json
import time

import pysoem
from probing import Cycle


def cycle_with(master, drive, period_us):
    """Return a cycle that exchanges the process data of a drive, after a first exchange."""

    def exchange(sent):
        drive.output = sent
        master.send_processdata()
        counter = master.receive_processdata(100_000)
        return drive.input, counter == master.expected_wkc

    cycle = Cycle(exchange, period_us * 1e-6)
    cycle(1)
    return cycle


def lead_to_op(master, cycle):
    """Ask for OP, and exchange until it is there, 5 s at most."""
    master.state = pysoem.OP_STATE
    master.write_state()
    end_s = time.perf_counter() + 5
    while master.state_check(pysoem.OP_STATE, 1000) != pysoem.OP_STATE:
        cycle(1)
        if time.perf_counter() > end_s:
            break
    master.read_state()


def end(master, said):
    """Lead the line back to INIT and print what was seen, as one JSON object."""
    master.state = pysoem.INIT_STATE
    master.write_state()
    master.close()
    print(json.dumps(said))
