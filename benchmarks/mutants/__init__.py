"""Mutants: planted mistakes that the tests of their package have to notice."""
