"""How a base does what it is told: commands shaped for it, what it will do, what it is like."""
