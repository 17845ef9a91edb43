"""What a run must show, computed beside the kernel: closed forms on the plant's truth."""
