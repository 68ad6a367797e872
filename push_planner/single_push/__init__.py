"""One push to a goal: feasibility, contact sites, planning and replanning."""
