"""Steered pushes: feasibility, contact sites, planning by collocation, and replanning."""
