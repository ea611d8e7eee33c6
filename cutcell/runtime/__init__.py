"""What the computation runs on: compiled kernels, threads, memory, progress and files."""
