"""The interface between channel and PLC side: values, control units, events; nothing acts here."""
