"""Ensemble filter: where robot and object are, and what their motion reveals of friction."""
