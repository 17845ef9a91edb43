"""The virtual drive on EtherCAT: slave controller, states, mailbox, CoE, and the servo on it."""
