"""Independent axes, couplings, exchange and homing of axes."""

from kernel.nc.decoder.topic import Topic

TOPIC = Topic()
