"""State estimation during a push: object, friction centre, contact, and monitors."""
