"""Widgets that Panel lacks: each is a Panel component whose view is a module of `frontend/`."""
