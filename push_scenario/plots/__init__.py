"""Figures and animations of what a run did."""
