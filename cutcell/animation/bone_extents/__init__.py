"""Where each bone ends inside the body."""
