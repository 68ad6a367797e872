"""Benchmark of the controller: random single pushes under every control law."""
