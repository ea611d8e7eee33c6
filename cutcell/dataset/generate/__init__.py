"""Generate random rigged characters."""
