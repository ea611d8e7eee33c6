"""Primitives of triangle meshes: edges, welding, normals, Laplacian, orders."""
