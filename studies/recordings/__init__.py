"""Recorded pushes of other people, and what the model predicts of them."""
