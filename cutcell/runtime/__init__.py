"""Infrastructure of the computation: compiled kernels, threads, memory, progress and files."""
