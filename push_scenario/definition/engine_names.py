"""Names of the engines, for who needs nothing else of them."""

# What moves robot and object: the simulator of the package, or MuJoCo.
ENGINES = 'own', 'mujoco'
