"""Case study 3 as an experiment: repeated straight pushes on a side, simulated or recorded."""
