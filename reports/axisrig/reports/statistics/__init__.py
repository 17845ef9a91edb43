"""Section of the report about statistics: values in their order, histogram, normal plot."""
