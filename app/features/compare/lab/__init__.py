"""Laboratory of the panel Compare: sweeps of an option, and settings to put side by side."""
