"""The simulated robot and object: plant, actuation, sensors, disturbances."""
