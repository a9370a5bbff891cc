"""Plain NumPy and SciPy formulations, independent of the kernels that they check."""
