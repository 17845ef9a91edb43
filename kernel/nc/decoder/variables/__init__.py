"""Variables of the decoder itself: own variables of the program and those of the PLC side."""

from kernel.nc.decoder.topic import Topic
from kernel.nc.decoder.variables import external, own

TOPIC = Topic(
    statements=own.TOPIC.statements,
    commands=own.TOPIC.commands,
    readers={**own.TOPIC.readers, "V.E": external.read},
    writers={**own.TOPIC.writers, "V.E": external.write},
)
