"""Where a base that is free to turn should roll its contact: normal and push through F."""

import math

EDGE_RESERVE = 0.02
VERTEX_RESERVE = 0.05


def centred_turn(site, center, allowed, rolled):
    """
    Turn of the robot in the object, since the start, that centres the contact.

    A contact whose normal runs through the friction centre F has the whole cone to either side.
    At a vertex n turns by the turn of the robot, on a face C moves by ``-R_p`` times it, on a
    round outline n turns by ``1 - lam`` times it. A disc must roll far for little: with p the
    distance of F from its centre and d the angle from n to that direction,
    ``tan(zeta) = -p sin(d) / (R_s + p cos(d))``; so only what exceeds ``allowed`` is rolled away,
    ``sin(d - zeta) = R_s sin(zeta) / p``.

    :param site: the contact ``Site``.
    :param center: friction centre F in the object frame (x, y) [m].
    :param allowed: zeta that a round contact may keep [rad].
    :param rolled: the present turn, from which a round contact takes the nearer way [rad].
    :return: the turn, bounded by the ends of the vertex or the face [rad].
    """
    n = site.normal
    if site.kind == 'vertex':
        ahead = math.atan2(center[1] - site.point[1], center[0] - site.point[0])
        low, high = site.normal_limits
        middle, room = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - VERTEX_RESERVE)
        wanted = math.remainder(ahead - middle, 2.0 * math.pi)
        return middle + min(room, max(-room, wanted)) - n
    if site.kind == 'face':
        aside, wanted = (y * math.cos(n) - x * math.sin(n) for x, y in (site.point, center))
        low, high = site.edges
        middle, room = 0.5 * (low + high), max(0.0, 0.5 * (high - low) - EDGE_RESERVE)
        if math.isfinite(room):
            wanted = middle + min(room, max(-room, wanted - middle))
        return (aside - wanted) / site.robot_radius
    return rolled + _round_turn(site, center, allowed, site.normal + (1.0 - site.share) * rolled)


def _round_turn(site, center, allowed, normal):
    distance = math.hypot(*center)
    from_center = math.remainder(math.atan2(center[1], center[0]) - normal, 2.0 * math.pi)
    share = site.object_radius * math.sin(allowed) / max(distance, 1e-9)
    if share >= 1.0:
        return 0.0
    ahead, behind = allowed + math.asin(share), allowed + math.pi - math.asin(share)
    apart = abs(from_center)
    if apart <= ahead or apart >= behind:
        return 0.0
    kept = ahead if apart - ahead <= behind - apart else behind
    return math.copysign(apart - kept, from_center * (apart - kept)) / (1.0 - site.share)
