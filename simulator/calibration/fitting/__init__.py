"""The fit: parameters and their priors, measurements, residuals and their minimization."""
