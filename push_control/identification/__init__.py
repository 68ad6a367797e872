"""Identification of friction from recorded pushes."""
