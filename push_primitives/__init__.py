"""
What short, straight pushes do to an object, and how long everything takes that remains to do.

``face_points`` lists where the robot may touch, ``table`` simulates straight pushes and arcs
there under many samples of friction, ``value_iteration`` computes the ``cost_to_go`` of what they
leave, ``store`` keeps both, and ``selection`` picks the next push; ``simplification`` leaves out
what of an object hardly matters.
"""
