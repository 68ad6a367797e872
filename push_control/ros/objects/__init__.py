"""Objects by name, and what is kept of each between goals and runs."""
