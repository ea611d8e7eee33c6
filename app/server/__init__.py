"""The server: access, its log, and memory of ended sessions."""
