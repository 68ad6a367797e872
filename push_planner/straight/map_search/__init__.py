"""
Search over straight pushes among the obstacles of a map.

``pushes`` prepares what pushes do, ``object_distance`` measures how far the object is from its
goal, ``reachable_set`` where the robot gets between pushes; ``search`` finds the chain, and
``planner`` turns its first push into a plan, or says why there is none.
"""
