"""How near to the limit simulation, control, replay and starts are."""
