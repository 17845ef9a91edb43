"""EtherCAT as a carrier: frames and their time on the wire, a line of slaves, records."""
