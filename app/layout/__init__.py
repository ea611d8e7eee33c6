"""Where everything is put on the page, and when a session of it begins and ends."""
