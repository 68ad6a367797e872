"""Collocation: a push as a nonlinear program, and the solvers for it."""
