"""Base colours, images and alpha modes of a file, for display and for new GLB files."""
