"""How near to the limit simulation, control, replay, batches and starts are."""
