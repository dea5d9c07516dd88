"""What every model computes with: quadrature, series, rigid motion, solvers, compiled kernels."""
