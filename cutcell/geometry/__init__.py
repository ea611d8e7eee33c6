"""Primitives of triangle meshes: edges, welding, normals, Laplacian, union-find."""
