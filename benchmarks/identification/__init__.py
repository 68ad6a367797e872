"""Identification of friction from pushes of simulated objects, whose friction is known."""
