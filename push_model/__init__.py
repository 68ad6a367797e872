"""The physics of single-point pushing, written once."""
