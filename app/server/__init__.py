"""The server: who is let in, what it logs, and memory that ended sessions held."""
