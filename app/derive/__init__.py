"""Work off the page's thread: in threads, in processes; and texts of errors."""
