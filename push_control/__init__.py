"""Feedback control of a push: measurements in, robot commands out."""
