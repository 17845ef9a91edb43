"""EtherCAT as both ends take it: commands, registers, states, codes, layouts; tables only."""
