"""Work off the page's own thread: in threads, in processes; and how errors are told."""
