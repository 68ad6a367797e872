"""Benchmark of tasks: lower bound, maps and clearances, random draws, interventions, groups."""

import dataclasses
import math
from types import SimpleNamespace

from benchmarks.controller.tables import ALL, table
from benchmarks.tasks.aims import aim_table, aims
from benchmarks.tasks.bases import (
    BAD_BASES, compared_jobs, DRAWN, GOOD, LEARNED, NOT_LEARNED, treatment,
)
from benchmarks.tasks.bound import contact_path_bound, gap, least_time
from benchmarks.tasks.cases import (
    BASE_PARTS, BASES, CREEPING, DISTURBED, draw, EYES_PARTS, FAR_ROBOTS, free_jobs, FRICTIONLESS,
    IN_MAPS, INFORMED, jobs, KINDS, MAX_SLOPE, odometry_jobs, OPEN, OWN_EYES, PARTS, PUBLIC_MAPS,
    SLIPPERY, SLOPES, SPATIAL, STRICT, TAG, Tolerance, WALLS, WHEELS,
)
from benchmarks.tasks.eyes import ALWAYS_SEEN, EYES, seen_jobs
from benchmarks.tasks.eyes_tables import eyes_table
from benchmarks.tasks.groups import faults_of, grouped, grouped_parts, kind, with_informed_times
from benchmarks.tasks.intervention import Disturbance, Intervention
from benchmarks.tasks.maps import (
    draw_floor, MAPS, object_clearance, robot_clearance, to_rectangles,
)
from benchmarks.tasks.run import state_times
from benchmarks.tasks.tables import recovery_table
from benchmarks.tasks.varieties import STRIDE, task_key
from helpers.objects import box
from helpers.push_problems import HOLONOMIC
import numpy as np
from push_control.events import TaskEvent
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.events import codes, PushEvent, sentence
from push_model.geometry import Pose
from push_planner.steered.site_selection import choose_site
import pytest

pytestmark = pytest.mark.slow
START = Pose(0.3, -0.2, 0.4)
# Largest distance of the robot from the object at the start, where it is not 2 m.
WITHIN = {FAR_ROBOTS: 10.0, WALLS: 6.5}


@pytest.mark.parametrize('goal', [Pose(1.2, 0.0, 0.0), Pose(0.8, 0.6, 1.0), Pose(0.5, -0.3, -2.0)])
def test_no_plan_is_shorter_than_the_bound(goal):
    """Those of the planner are found without it."""
    plan = choose_site(box(), HOLONOMIC, START, START @ goal).plan
    assert contact_path_bound(box(), START, START @ goal) < plan.report['path_length']


def test_a_straight_push_is_nearly_as_short_as_the_bound():
    """Through the friction centre nothing is wasted but what the tolerances allow."""
    plan = choose_site(box(), HOLONOMIC, START, START @ Pose(1.0, 0.0, 0.0)).plan
    assert plan.report['path_length'] == pytest.approx(1.0, abs=1e-3)
    bound = contact_path_bound(box(), START, START @ Pose(1.0, 0.0, 0.0))
    assert bound == pytest.approx(0.98, abs=0.01)


def test_the_bound_does_not_depend_on_the_world():
    """Nor on the direction of time; where the object is there already it is 0."""
    world, goal = Pose(-2.0, 1.0, 2.2), START @ Pose(0.4, 0.1, 1.3)
    assert contact_path_bound(box(), world @ START, world @ goal) == pytest.approx(
        contact_path_bound(box(), START, goal))
    back = contact_path_bound(box(), goal, START)
    assert back == pytest.approx(contact_path_bound(box(), START, goal))
    assert contact_path_bound(box(), START, START) == 0.0


def test_feet_with_more_friction_count_more():
    """A rotation about the only foot with friction costs nothing."""
    still = box(friction=(0.3, 1e-9, 1e-9, 1e-9))
    foot = still.supports[0]
    about = Pose(foot.x, foot.y, 0.0)
    turned = START @ about @ Pose(0.0, 0.0, 1.0) @ about.inverse()
    assert contact_path_bound(still, START, turned) == pytest.approx(0.0, abs=1e-6)
    assert contact_path_bound(box(), START, turned) > 0.1


@pytest.mark.parametrize('name', MAPS)
def test_the_map_shows_the_walls_and_obstacles_of_the_floor(name):
    """Cell by cell; there is a wall all round."""
    floor = draw_floor(name, np.random.default_rng(3))
    cells = floor.map.occupancy_map.occupied
    rows, columns = np.indices(cells.shape)
    centers = floor.map.resolution * (np.column_stack([columns.ravel(), rows.ravel()]) + 0.5)
    inside = to_rectangles(centers, floor.rectangles).min(axis=1) < 0.0
    assert np.array_equal(cells.ravel(), inside)
    assert cells[[0, -1]].all() and cells[:, [0, -1]].all() and not cells.all()


def test_a_corridor_is_1_m_wide():
    """And joins two rooms."""
    floor = draw_floor('corridor', np.random.default_rng(1))
    free = ~floor.map.occupancy_map.occupied
    middle = free[:, free.shape[1] // 2]
    assert floor.map.resolution * middle.sum() == pytest.approx(1.0)
    assert np.flatnonzero(np.diff(middle)).size == 2


def test_clearances_of_robot_and_object_are_those_of_their_outlines():
    """Compared with points all along them; poses where both are near a wall, or across it."""
    rng = np.random.default_rng(5)
    rectangles = np.array([(0.0, 0.0, 0.1, 2.0), (1.0, 0.5, 1.4, 0.9)])
    corners = np.array(box().outline)
    along = np.linspace(0.0, 1.0, 401)[:, None]
    outline = np.concatenate(
        [a + along * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0))])
    angles = np.linspace(0.0, 2.0 * math.pi, 4001)
    circle = HOLONOMIC.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    for pose in np.round(rng.uniform((-0.5, -0.5, -3.0), (2.0, 2.5, 3.0), (40, 3)), 3):
        found = (object_clearance(box(), [pose], rectangles),
                 robot_clearance(HOLONOMIC, [pose], rectangles))
        for clearance, points in zip(found, (outline, circle)):
            seen = np.array([Pose(*pose).transform(point) for point in points])
            expected = to_rectangles(seen, rectangles).min()
            assert (clearance < 0.0) == (expected < 0.0)
            assert (expected < 0.0
                    or clearance - 1e-3 < expected < math.sqrt(2.0) * clearance + 2e-3)


def test_a_far_robot_is_compared_with_itself_without_a_lidar():
    """All else of the task is the same, and only the one uses scans."""
    tasks = jobs(FAR_ROBOTS, 2)
    for job, alone in zip(tasks, odometry_jobs(tasks)):
        by_lidar, by_odometry = draw(**job), draw(**alone)
        assert (by_lidar.variety, by_odometry.variety) == ('lidar', 'odometry alone')
        with_lidar, plain = by_lidar.scenario, by_odometry.scenario
        assert with_lidar.start == plain.start and with_lidar.goal == plain.goal
        assert with_lidar.true_object == plain.true_object
        assert (with_lidar.task.place.source, plain.task.place.source) == ('scan', 'none')
        assert plain.sensors.lidar.rate == 0.0 < with_lidar.sensors.lidar.rate


def test_bins_at_walls_are_compared_with_themselves_with_any_heading() -> None:
    """All else of the task is the same; objects with faces run once."""
    tasks = jobs(WALLS, len(KINDS[WALLS]))
    job, = free_jobs(tasks)
    assert job['kind'] == 'bin, holonomic'
    free, stated = draw(**job), draw(**{**job, 'base': LEARNED})
    assert free.tolerance.heading >= math.pi > stated.tolerance.heading
    task = free.scenario.task
    assert dataclasses.replace(free.scenario, task=dataclasses.replace(
        task, supervision=stated.scenario.task.supervision)) == stated.scenario
    assert task.supervision.heading_tolerance == free.tolerance.heading


@pytest.mark.parametrize('part', [part for part in PARTS if part != PUBLIC_MAPS])
def test_a_task_is_drawn_from_its_seed_alone(part):
    """Every kind and every seed gets another; the robot stands clear of the object."""
    drawn = {}
    for job in jobs(part, 3 * len(KINDS[part])):
        case, again = draw(**job), draw(**job)
        assert case.scenario == again.scenario and case.variety == again.variety
        drawn[case.scenario.goal, case.variety] = case
        assert gap(case.scenario) >= 0.05
        assert math.dist(case.scenario.robot_start[:2],
                         case.scenario.start.object.pose[:2]) <= WITHIN.get(part, 2.0)
        assert 0.0 < least_time(case.scenario) < case.scenario.time_limit
    assert len(drawn) == 3 * len(KINDS[part])
    varieties = {IN_MAPS: 3, DISTURBED: 2, WHEELS: 2, STRICT: 2, WALLS: 3}
    if part in BASE_PARTS:
        varieties[part] = min(len(BAD_BASES), 3 * len(KINDS[part]))
    if part in EYES_PARTS:
        varieties[part] = min(len(EYES), 3 * len(KINDS[part]))
    assert len({case.variety for case in drawn.values()}) == varieties.get(part, 1)


def test_the_first_tasks_do_not_depend_on_how_many_there_are():
    """So that few of them say something about many."""
    assert jobs(OPEN, 100)[:9] == jobs(OPEN, 9)
    only = jobs(OPEN, 3, [KINDS[OPEN][2]])
    assert [(job['kind'], job['seed']) for job in only] == [(KINDS[OPEN][2], i) for i in range(3)]


def test_a_variation_changes_one_thing_of_the_task_on_open_floor():
    """Goal, start, object and noise stay, so that both can be compared one by one."""
    changed = {SLIPPERY: {'true_object'}, FRICTIONLESS: {'true_object'}, CREEPING: {'simulation'},
               WHEELS: {'sensors'}, TAG: {'sensors', 'control', 'task'},
               INFORMED: {'object', 'sensors', 'task'}, SPATIAL: {'true_object'}}
    for part, fields in changed.items():
        for job in jobs(part, 2 * len(KINDS[part])):
            plain, varied = draw(**{**job, 'part': OPEN}).scenario, draw(**job).scenario
            different = {field.name for field in dataclasses.fields(plain)
                         if getattr(plain, field.name) != getattr(varied, field.name)}
            assert different - {'description'} == fields
    slippery = [draw(**{**job, 'part': SLIPPERY}).scenario for job in jobs(OPEN, 50)]
    frictions = [scenario.true_object.contact_friction_coefficient for scenario in slippery]
    assert 0.15 <= min(frictions) < 0.17 and 0.28 < max(frictions) <= 0.3
    assert {scenario.object.contact_friction_coefficient for scenario in slippery} == {0.5}


@pytest.mark.parametrize('part', BASE_PARTS)
def test_every_bad_base_comes_equally_often_with_the_same_tasks(part):
    """Also where their number is no multiple; all objects and drives come."""
    chosen = jobs(part, 8 * len(BAD_BASES) + 3)
    tasks = {}
    for job in chosen:
        tasks.setdefault(draw(**job).variety, []).append(task_key(job))
    assert list(tasks) == list(BAD_BASES)
    assert [len(found) for found in tasks.values()] == [9] * 3 + [8] * (len(BAD_BASES) - 3)
    assert all(found[:8] == tasks[DRAWN] for found in tasks.values())
    assert {kind for _, kind, _ in tasks[DRAWN]} == set(KINDS[part])


@pytest.mark.parametrize('part', EYES_PARTS)
def test_all_eyes_get_the_same_tasks_and_each_of_these_is_compared_once(part):
    """With the object always seen the task is that on open floor, but for who moves it."""
    chosen = jobs(part, 4 * len(EYES))
    assert [draw(**job).variety for job in chosen] == 4 * list(EYES)
    compared = seen_jobs(chosen)
    assert {task_key(job) for job in chosen} == {task_key(job) for job in compared}
    assert len(compared) == 4
    for job in compared:
        number = job['seed'] // STRIDE
        seen, plain = draw(**job).scenario, draw(OPEN, job['kind'], number).scenario
        same = 'start', 'goal', 'sensors', 'control', 'task'
        assert part != OWN_EYES or all(getattr(seen, name) == getattr(plain, name)
                                       for name in same)


def test_who_says_done_too_early_or_is_slow_stands_out_in_the_table_of_eyes():
    """Rates, false claims and ratios of times are those of the records."""
    name = list(EYES)[0]
    made = [({'part': OWN_EYES, 'kind': KINDS[OWN_EYES][0], 'seed': STRIDE * number},
             {'variety': name, 'success': number > 1, 'outcome': 'done', 'duration': 45.0,
              'position_error': 0.02, 'heading_error': 0.01, 'pushes': 3,
              'stated_position': 0.006, 'stated_heading': 0.01, 'is_as_stated': number == 1})
            for number in range(4)]
    made += [({**job, 'base': ALWAYS_SEEN},
              {**record, 'variety': ALWAYS_SEEN, 'success': True, 'duration': 30.0})
             for job, record in made]
    head, _, row = eyes_table(made, OWN_EYES).splitlines()
    cells = dict(zip(head.split(' | '), row.split(' | ')))
    assert cells['done within the tolerances'].startswith('**2 of 4')
    assert cells['says done'] == '4' and cells['within what it states'] == '3'
    assert cells['says done and is neither'] == '1' and cells['stated, median'] == '6; 0.6'
    assert cells['time over always seen, median'] == '**1.50**'
    assert cells['mm; deg, median, of those that say done'] == '20; 0.6'


def test_nothing_of_a_bad_base_is_stated():
    """Only true values, the drive and the odometry differ from the task on open floor."""
    name = KINDS[BASES][0]
    plain = draw(OPEN, name, 0).scenario
    for seed, base in enumerate(BAD_BASES.values()):
        scenario = draw(BASES, name, seed).scenario
        different = {field.name for field in dataclasses.fields(plain)
                     if getattr(plain, field.name) != getattr(scenario, field.name)}
        assert {'description'} < different
        assert different <= {'description', 'true_object', 'true_robot', 'simulation', 'sensors'}
        assert scenario.true_object == dataclasses.replace(
            plain.true_object, mass=base.mass_ratio * plain.true_object.mass)


def test_bad_bases_are_compared_with_the_same_tasks():
    """Once with nothing learned, where nothing else differs, and once for all with a good base."""
    learned = jobs(BASES, 2 * len(BAD_BASES))
    others = compared_jobs(learned)
    assert len(others) == len(learned) + 2
    for job, without in zip(learned, others):
        case, same = draw(**job), draw(**without)
        assert treatment(without) == NOT_LEARNED and case.variety == same.variety
        assert case.scenario.robot.identify_base and not same.scenario.robot.identify_base
        assert same.scenario == dataclasses.replace(case.scenario, robot=same.scenario.robot)
    for job in others[len(learned):]:
        good = draw(**job).scenario
        plain = draw(OPEN, job['kind'], 0).scenario
        assert treatment(job) == GOOD
        assert dataclasses.replace(good, description=plain.description) == plain
        assert task_key(job) in map(task_key, learned)


def test_drawn_bases_spread_over_their_ranges():
    """Before the lag mostly, each task with another one."""
    robots, limits = [], {'min_speed': [], 'output_min_speed': []}
    for job in jobs(BASES, 40 * len(BAD_BASES)):
        case = draw(**job)
        if case.variety != DRAWN:
            continue
        robot, drive = case.scenario.true_robot, case.scenario.simulation.drive
        robots.append((robot.dead_time, robot.time_constant))
        assert not (robot.min_speed and drive.output_min_speed)
        name = 'min_speed' if robot.min_speed else 'output_min_speed'
        limits[name].append(robot.min_speed or drive.output_min_speed)
    assert 15 <= len(limits['min_speed']) <= 33
    low, high = np.min(robots, axis=0), np.max(robots, axis=0)
    assert low == pytest.approx((0.0, 0.04), abs=0.03)
    assert high == pytest.approx((0.3, 0.15), abs=0.03) and (high <= (0.3, 0.15)).all()
    assert max(limits['min_speed'] + limits['output_min_speed']) <= 0.09
    assert len(set(robots)) == 40


def test_slopes_are_drawn_up_to_the_steepest():
    """In all directions."""
    slopes = np.array([draw(**job).slope for job in jobs(SLOPES, 40)])
    assert 0.0 < slopes[:, 0].min() and 0.85 * MAX_SLOPE < slopes[:, 0].max() <= MAX_SLOPE
    assert len(set(np.sign(np.sin(slopes[:, 1])) + 2.0 * np.sign(np.cos(slopes[:, 1])))) == 4


def test_strict_tasks_are_those_of_open_floor_with_each_tolerance():
    """The supervisor has the tolerance by which the task is judged."""
    name = KINDS[OPEN][1]
    for seed in range(4):
        plain, strict = draw(OPEN, name, seed // 2), draw(STRICT, name, seed)
        assert strict.scenario.goal == plain.scenario.goal
        assert strict.scenario.true_object == plain.scenario.true_object
        assert strict.tolerance != plain.tolerance == Tolerance()
        supervision = strict.scenario.task.supervision
        assert strict.tolerance == (supervision.position_tolerance, supervision.heading_tolerance)
        assert strict.variety == str(strict.tolerance)
    assert str(Tolerance(0.003, math.radians(0.3))) == '3 mm, 0.3 deg'


@pytest.mark.parametrize('seed', range(3))
def test_in_maps_start_and_goal_are_clear(seed):
    """For the object, and for the robot where it stands."""
    case = draw(IN_MAPS, KINDS[IN_MAPS][0], seed)
    scenario, floor = case.scenario, case.floor
    ends = [scenario.start.object.pose, scenario.goal.pose]
    assert object_clearance(scenario.true_object, ends, floor.rectangles) > 0.4
    assert robot_clearance(scenario.true_robot, [scenario.robot_start], floor.rectangles) > 0.1
    occupancy_map = scenario.task.occupancy_map
    assert occupancy_map.object_is_free(scenario.object, ends, 0.05)


@pytest.mark.parametrize('disturbance', Disturbance)
def test_the_intervention_waits_until_the_robot_is_clear(disturbance):
    """Then it moves the object once."""
    puts, barred = [], [True]

    def set_object_pose(pose):
        if barred[0]:
            raise ValueError('the robot is in the way')
        puts.append(pose)

    plant = SimpleNamespace(set_object_pose=set_object_pose, object_pose=START)
    supervisor = SimpleNamespace(status=SimpleNamespace(state=TaskState.PUSH))
    intervention = Intervention(disturbance, 2.0, -1.0)
    unseen = disturbance is Disturbance.CARRIED_AWAY
    for time, is_seen in ((1.0, False), (3.0, unseen)):
        intervention(SimpleNamespace(time=time, plant=plant, is_object_seen=is_seen), supervisor)
    assert intervention.displacement is None
    barred[0] = False
    if unseen:
        intervention(SimpleNamespace(time=3.5, plant=plant, is_object_seen=True), supervisor)
        assert intervention.displacement is None
    for time in (4.0, 5.0):
        intervention(SimpleNamespace(time=time, plant=plant, is_object_seen=not unseen),
                     supervisor)
    moved = START.inverse() @ puts[0]
    assert len(puts) == 1
    assert intervention.displacement.time == 4.0 and intervention.state == 'push'
    expected = {Disturbance.DISPLACED: (0.2, 0.0), Disturbance.CARRIED_AWAY: (0.6, 0.0),
                Disturbance.ROTATED: (0.0, -math.radians(45.0))}[disturbance]
    assert (math.hypot(moved.x, moved.y), moved.theta) == pytest.approx(expected, abs=1e-12)


def test_tasks_are_counted_by_kind():
    """Failures by the codes of their reason; collisions besides; no single push counts."""
    names = KINDS[OPEN][:2]
    pairs = [({'part': OPEN, 'kind': names[index % 2], 'seed': index}, record)
             for index, record in enumerate([
                 {'success': True, 'outcome': 'done', 'duration': 30.0, 'single': 60.0,
                  'planning': '0.25 0.50'},
                 {'success': True, 'outcome': 'done', 'duration': 30.0, 'single': math.inf,
                  'planning': '1.0', 'robot_clearance': -0.01},
                 {'success': False, 'outcome': 'done', 'planning': '', 'reason': ''},
                 {'success': False, 'outcome': 'failed', 'reason': 'off by 3.5 mm',
                  'codes': 'PushEvent.GOAL_MISSED'}])]
    everything, first, second = grouped(pairs, OPEN, kind)
    assert (everything.name, first.name, second.name) == (ALL, *names)
    assert (everything.successes, first.successes, second.successes) == (2, 1, 1)
    assert everything.ratios('duration', 'single') == pytest.approx([0.5, 0.0])
    assert everything.planning == pytest.approx([0.25, 0.5, 1.0])
    assert [faults_of(*pair) for pair in pairs] == [
        [], ['robot collides'], ['says that it is done, and is not'],
        ['failed: PushEvent.GOAL_MISSED']]
    assert (everything.falsely_done, first.falsely_done) == (1, 1)
    assert grouped(pairs, IN_MAPS, kind) == []


def test_an_end_without_a_code_is_named_by_its_outcome():
    """Out of time, say; an error of the benchmark has the name of its exception in its place."""
    (timed_out, error) = ({'success': False, 'outcome': outcome, 'reason': '3 s', 'codes': code}
                          for outcome, code in (('timed out', ''), ('error', 'ValueError')))
    assert faults_of({}, timed_out) == ['timed out']
    assert faults_of({}, error) == ['error: ValueError']


def test_recoveries_are_counted_by_their_codes():
    """Whatever numbers their sentences name."""
    history = [StateChange(float(index), TaskState.PLAN, sentence(cause), codes=codes(cause))
               for index, cause in enumerate([
                   None, *(PushEvent.GAP_TOO_WIDE.report(gap=gap) for gap in (3.0, 8.0)),
                   None, TaskEvent.ABORTED.report(reason='end')])]
    record = state_times(SupervisorStatus(history=tuple(history)), 5.0)
    assert recovery_table([({}, record)]) == table(
        ['what', 'n'], [(str(PushEvent.GAP_TOO_WIDE), 2)])
    assert recovery_table([({}, {})]) == 'Nothing.'


def result_of(part, seed, **record):
    """Return (job, record) of a task that succeeded after a minute."""
    return ({'part': part, 'kind': KINDS[OPEN][0], 'seed': seed},
            {'success': True, 'outcome': 'done', 'reason': '', 'duration': 60.0, 'planning': '0.5',
             'pushes': 2, **record})


def test_parts_follow_each_other():
    """Those that were measured, in the order that is asked for."""
    pairs = [result_of(part, seed) for seed in range(2) for part in (OPEN, WHEELS)]
    groups = grouped_parts(pairs, (WHEELS, STRICT, OPEN))
    assert [(group.part, len(group.tasks)) for group in groups] == [(WHEELS, 2), (OPEN, 2)]


def test_time_over_that_of_the_informed_robot_is_of_the_same_task():
    """Tasks in which that robot fails are left out."""
    pairs = [result_of(OPEN, 0), result_of(OPEN, 1), result_of(OPEN, 2),
             result_of(INFORMED, 0, duration=40.0), result_of(INFORMED, 1, success=False)]
    group, = grouped(with_informed_times(pairs), OPEN)
    assert group.ratios('duration', 'informed') == pytest.approx([1.5])


@pytest.mark.parametrize('results, success, time, is_done', [
    ([{'duration': 20.0, 'planning': '0.01'}] * 3,
     '100.0 % (43.8 to 100.0; 3 of 3), 20 s', '20 / 20', '0 of 3'),
    ([{'success': False}, {}, {}],
     '**66.7 % (20.8 to 93.9; 2 of 3), 60 s**', '**60 / 60**', '**1 of 3**')])
def test_what_falls_short_of_its_aim_is_bold(results, success, time, is_done):
    """One row for every aim; what is not measured is not bold."""
    lines = aim_table([result_of(OPEN, seed, **record)
                       for seed, record in enumerate(results)]).splitlines()
    assert len(lines) == 2 + len(aims())
    rows = {cells[0]: cells[2] for cells in
            ([cell.strip() for cell in line.strip('|').split('|')] for line in lines)}
    assert rows['open floor: at rest within 10 mm and 1 deg'] == success
    assert rows['differential drive: time, median / p95, s'] == time
    assert rows['holonomic drive: time, median / p95, s'] == '-'
    assert rows['says done and is not, in all parts'] == is_done
