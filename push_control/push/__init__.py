"""One push: open loop or with feedback, from first contact to the goal or a failure."""
