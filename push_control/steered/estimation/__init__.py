"""State estimation during a steered push: object, centre of friction and contact."""
