"""The sections of the sidebar, one file each: `section(session) -> Viewable`."""
