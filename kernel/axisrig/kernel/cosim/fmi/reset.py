"""An instance that is used again: set aside when a run ends, reset in place of loading it anew.

After `fmi2Reset` or `fmi3Reset` an instance is as after its instantiation (FMI 2.0.4, 2.1.6; FMI
3.0.1, 2.2.3). Which FMUs may be trusted with that is for the caller to know.
"""

import ctypes
from collections import deque

from axisrig.kernel.cosim.fmi.library import WARNING, Missing
from axisrig.kernel.cosim.fmi.slave import MESSAGES_MAX, POINTER, FmuSlave


def set_aside(slave: FmuSlave) -> int:
    """Take an instance out of use; return its handle for `reset`.

    0: it may not be used again and is to be closed. It was not initialised, has failed, or may
    exist only once per process.
    """
    if not (slave.pointer and slave._can_terminate) or slave.can.once_per_process:
        return 0
    for state in slave._states:
        slave._free(slave.pointer, ctypes.addressof(state.handle))
    slave._states.clear()
    handle, slave.pointer = slave.pointer, 0
    return handle


def reset(slave: FmuSlave, handle: int) -> bool:
    """Make an instance that was set aside as new; handle: what `set_aside` gave.

    False when the FMU has no such function or it fails: the instance is to be closed then.
    """
    slave.pointer = handle
    slave.messages = deque(maxlen=MESSAGES_MAX)
    slave.time_ns = slave._stands_ns = 0
    slave._excess_s = 0.0
    slave._is_final, slave._can_terminate, slave._is_fatal = True, False, False
    slave._cut.value = 0
    call = slave.function(f"{slave.PREFIX}Reset", (POINTER,))
    return not isinstance(call, Missing) and call(handle) <= WARNING
