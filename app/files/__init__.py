"""Files of characters: received from browsers, kept for a while, and read."""
