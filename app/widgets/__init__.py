"""What Panel has no widget for: each is a Panel component whose view is a module of `frontend/`."""
