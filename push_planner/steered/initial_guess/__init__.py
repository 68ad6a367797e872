"""Initial guesses for the nonlinear program."""
