"""Variables of the decoder itself: own ones, state, PLC side."""

from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.decoder.variables import external, own, state

TOPIC = Topic(
    statements=own.TOPIC.statements,
    commands=own.TOPIC.commands,
    readers={**own.TOPIC.readers, **state.TOPIC.readers, "V.E": external.read},
    writers={**own.TOPIC.writers, "V.E": external.write},
)
