"""What goes on beside the runs of a campaign: its progress, and the running run for who looks on.

Here are the only threads of axisrig.
"""
