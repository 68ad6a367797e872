"""
Compiled dynamics of object and robot: contact, support friction and actuation, integrated in time.

The simulated plant is built on it, and so is whatever predicts pushes by the thousand.
"""
