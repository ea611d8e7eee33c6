"""Triangle meshes: welded meshes and what follows from them, lines that hit them, orders."""
