"""
Approach of the robot to a contact: candidates round the object, the quickest of which is taken.

A candidate is a sequence of straight lines and arcs from one pose to another,

    departure (straight, arc) - first curve - round corners of the object - last curve -
    arrival (arc, straight)

A differential drive departs and arrives in one gear and moves between the two in the same or in
the other one, so that it changes its direction once at most; for a holonomic base only directions
of motion count. Frame of the object, SI units.

``encoding`` names the numbers, ``layout`` draws the lines, ``timing`` and ``clearance`` judge
them, and ``search`` finds the quickest: all compiled. ``approach_path`` makes a path of it.
"""
