"""The path behind a distance, for display."""
