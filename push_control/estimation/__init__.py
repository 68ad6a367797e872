"""State estimation during a push: object, centre of friction, contact, and monitors."""
