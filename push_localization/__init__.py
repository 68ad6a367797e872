"""
The place of the robot in a known map, by scans of a lidar.

``wall_field`` is the map as a signed distance, ``scan_points`` makes points at one time of a scan,
``object_beams`` takes those away that see the pushed object. ``matching`` compares points with
walls, ``search`` looks for a place from afar, ``fusion`` says how certain it is, and ``localizer``
puts these together, scan by scan. ``place_noise`` tells by how much the places of another
localization err more than they state.
"""
