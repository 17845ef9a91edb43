"""Says what a program is about that does not end: the block, what it waits for, the loop."""

from axisrig.kernel.channel import Channel, ChannelState
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.time.clock import S

_NOT_RUNNING = {
    ChannelState.STARTING: "the drives have not started",
    ChannelState.POWERING: "the drives are not enabled",
    ChannelState.STOPPING: "the axes do not come to rest after an alarm",
    ChannelState.RESETTING: "the axes do not come to rest after a reset",
    ChannelState.READY: "the PLC side still has something to do",
    ChannelState.ERROR: "the PLC side still has something to do after an alarm",
}
_WAITS = {
    canon.ExactStop: "the axes in their exact-stop windows",
    canon.EndOfProgram: "the axes in their exact-stop windows",
    canon.WaitIndependent: "independent axes at their targets",
    canon.DriveRead: "the answer of a drive",
    canon.DriveWrite: "the answer of a drive",
    canon.DriveWait: "the answer of a drive",
    canon.Homing: "homing",
    canon.TechnologyFunction: "the PLC side to acknowledge it",
}


def in_words(channel: Channel, interpreter: Interpreter) -> str:
    """Name the block under execution, what it waits for, the loop around it, and the axes."""
    parts = [_at(channel)]
    loop = interpreter.busiest_loop()
    if loop is not None:
        begin, turns = loop
        parts.append(f"the loop of {begin.place} ({begin.text}) has made {turns} turns")
    if channel.path.is_held:
        parts.append("the PLC side holds the path (feedhold)")
    stand = ", ".join(f"{link.name} {link.actual_mm:.3f}" for link in channel.links)
    return "; ".join([*parts, f"the axes are at {stand} mm"])


def _at(channel: Channel) -> str:
    command = at_work(channel)
    if command is None:
        return waited_for(channel)
    block = command.block
    return f"{block.place} ({block.text}) waits for {waited_for(channel)}"


def at_work(channel: Channel) -> canon.Command | None:
    """Return the command that keeps the program from going on, None while none is carried out."""
    if channel.state is not ChannelState.RUNNING:
        return None
    execution = channel.execution
    return execution.begun if execution.is_busy() else execution.head or execution.begun


def waited_for(channel: Channel) -> str:
    """Name what the command at work waits for; without one, why there is none."""
    command = at_work(channel)
    if command is not None:
        return _wanted(command)
    if channel.state is not ChannelState.RUNNING:
        return _NOT_RUNNING.get(channel.state, "the program has ended")
    return "nothing has begun"


def _wanted(command: canon.Command) -> str:
    if isinstance(command, canon.Dwell):
        return f"the end of its dwell time of {command.duration_ns / S:g} s"
    if isinstance(command, canon.ProgramStop):
        return "the start of the operator (plc:start_ms)"
    if isinstance(command, canon.Wait):
        return "the next cycle to ask the PLC side" if command.for_cycle else "the machine"
    if isinstance(command, canon.LinearMove | canon.ArcMove | canon.MeasuringRun):
        return f"the end of its move{_target(command)}"
    if isinstance(command, canon.IndependentMove):
        return f"axis {command.axis} at {command.target_mm:.9g} mm"
    return _WAITS.get(type(command), "the machine")


def _target(command: canon.LinearMove | canon.ArcMove | canon.MeasuringRun) -> str:
    target = ", ".join(f"{axis} {mm:.9g}" for axis, mm in command.target_mm.items())
    feed = command.feed_mm_min
    return f" to {target} mm" + ("" if feed is None else f" with {feed:.9g} mm/min")
