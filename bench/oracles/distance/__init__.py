"""What distance control must do, in closed form; nothing of it comes from the kernel."""
