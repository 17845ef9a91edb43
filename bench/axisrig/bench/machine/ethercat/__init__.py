"""CiA 402 on EtherCAT in operation: lines, slaves, the control's ends, what is recorded of them."""
