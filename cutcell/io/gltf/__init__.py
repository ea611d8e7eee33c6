"""glTF 2.0: documents, and reading and writing of their skinned meshes."""
