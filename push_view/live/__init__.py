"""What a live page shows: a session of the simulation, or a robot."""
