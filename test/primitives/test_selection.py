"""Laws of the selection of a push, of the weights of guesses and of the store."""

from concurrent import futures
import math
import threading

from helpers.objects import bin_
import numpy as np
from push_dynamics.private_folder import PrivateFolder
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_primitives import store, value_iteration
from push_primitives.selection import (
    estimate_travel_times, interpolate_displacements, MIN_CONTACT_TIME, push_costs, select_push,
    SelectionQuery, UNREACHED_STARTS,
)
from push_primitives.weights import FrictionBelief, sample_weights
import pytest

BIN = bin_(feet=4)
ROBOT = RoundRobot(radius=0.17, max_speed=0.3)
BELIEF = FrictionBelief(friction_center(BIN), 0.5, 0.03, 0.1)
GOALS = [Pose(0.02, -0.01, 0.05), Pose(-0.1, 0.2, 0.3), Pose(1.2, 0.3, -1.0), Pose(0.0, 0.0, 0.1)]
# No measure of speed: it only keeps a suite from hanging [s].
TIMEOUT = 400.0

pytestmark = pytest.mark.slow


@pytest.fixture(scope='module')
def primitives():
    """Return the primitives of a bin."""
    return store.load_primitives(BIN, ROBOT)


def query(goal, **changes):
    """Return a query for a robot half a metre away."""
    return SelectionQuery(goal, Pose(-0.5, 0.2, 0.3), BELIEF, 0.005, 0.17)._replace(**changes)


def estimated(primitives, asked):
    """Return travel times that are as estimated."""
    times = estimate_travel_times(primitives, asked.robot_pose)
    by_start = dict(zip(map(tuple, primitives.table.starts.tolist()), times.tolist()))
    return lambda start: by_start[tuple(start)]


@pytest.mark.parametrize('goal', GOALS)
def test_a_push_is_expected_to_bring_the_goal_nearer(primitives, goal):
    """What remains is less than before; the whole is not below the fixed times."""
    asked = query(goal)
    selected = select_push(primitives, asked, estimated(primitives, asked))
    before = min(primitives.cost_to_go.at(goal, face) for face in range(4))
    assert 0.0 <= selected.remaining_time < before
    fixed = MIN_CONTACT_TIME + primitives.settings.push_time + selected.length / 0.17
    assert selected.expected_time >= fixed
    assert selected.expected_time == pytest.approx(
        max(MIN_CONTACT_TIME, selected.travel_time) + primitives.settings.push_time
        + selected.length / 0.17 + selected.remaining_time)
    assert selected.length >= 0.12 * math.hypot(goal.x, goal.y) - 0.01
    assert selected.length <= 1.0


def test_standing_at_the_place_makes_no_push_free(primitives):
    """A path of no length counts as the least time of a contact."""
    asked = query(GOALS[1])
    selected = select_push(primitives, asked, lambda start: 0.0)
    assert selected.expected_time >= (MIN_CONTACT_TIME + primitives.settings.push_time
                                      + selected.length / 0.17)


def test_the_expectation_is_that_of_plain_numpy(primitives):
    """The compiled kernel averages V over the weighted guesses."""
    asked = query(GOALS[1])
    weights = sample_weights(primitives.table.friction_samples, BELIEF)
    displacements = primitives.localized_displacements
    costs = push_costs(primitives, asked, displacements, weights)
    chosen = np.argwhere(np.isfinite(costs))[::97]
    assert len(chosen) > 10
    for index, step in chosen.tolist():
        after = [primitives.cost_to_go.at(Pose(*displacement).inverse() @ asked.goal,
                                          int(primitives.table.faces[index]))
                 for displacement in displacements[index, :, step]]
        time = primitives.table.lengths[step] / 0.17 + primitives.settings.push_time
        assert costs[index, step] == pytest.approx(float(weights @ after) + time, rel=1e-6)


def test_starts_without_a_path_are_left_out(primitives):
    """One that is reachable among those tried is the answer; else few paths are asked for."""
    asked, tried = query(GOALS[1]), []

    def blocked(start):
        tried.append(start)
        return math.inf
    assert select_push(primitives, asked, blocked) is None
    only = tried[-1]
    selected = select_push(primitives, asked,
                           lambda start: 3.0 if start == only else math.inf)
    assert Pose(*primitives.table.starts[selected.primitive].tolist()) == only
    # What is in the way of the robot is in the way to all, and each path takes a while.
    assert len(tried) == UNREACHED_STARTS < len(primitives.table.starts)


def test_the_same_query_has_the_same_answer(primitives):
    """Whatever was asked between."""
    asked = query(GOALS[2])
    answers = []
    for _ in range(2):
        answers.append(select_push(primitives, asked, estimated(primitives, asked)))
        for goal in GOALS:
            select_push(primitives, query(goal), estimated(primitives, query(goal)))
    assert answers[0].primitive == answers[1].primitive
    assert answers[0].length == answers[1].length


def test_effects_scatter_more_by_an_unsure_robot(primitives):
    """By up to the ratio of the deviations, where errors of length do not count."""
    table = primitives.table
    errors = [np.sqrt(((displacements - table.displacements) ** 2).mean(axis=(0, 1)))
              for displacements in (primitives.localized_displacements,
                                    primitives.unsure_displacements)]
    assert (errors[1][10:] > 1.5 * errors[0][10:]).all()
    assert (errors[1] >= errors[0]).all()


def test_weights_follow_what_is_known_and_never_collapse(primitives):
    """Slippery guesses count once a slippery contact has been learned; four share the weight."""
    samples = primitives.table.friction_samples
    slippery = samples.contact_frictions < 0.3 * 0.5
    usual = sample_weights(samples, BELIEF)
    learned = sample_weights(samples, BELIEF._replace(contact_friction=0.05,
                                                      contact_friction_deviation=0.02))
    assert usual[slippery].sum() < 0.05 < 0.5 < learned[slippery].sum()
    for center in ((0.0, 0.0), (0.03, -0.02), (1.0, 0.0)):
        weights = sample_weights(samples, BELIEF._replace(center=center, center_deviation=0.0))
        assert weights.sum() == pytest.approx(1.0)
        assert 1.0 / (weights ** 2).sum() >= 4.0 - 1e-6
    aside = sample_weights(samples, BELIEF._replace(center=(0.02, 0.0), center_deviation=0.001))
    assert aside @ samples.centers[:, 0] > 0.005


def test_lengths_between_those_of_the_table_are_interpolated(primitives):
    """At its own lengths the table is exact."""
    table = primitives.table
    between = interpolate_displacements(table.lengths, table.displacements[3], table.lengths)
    np.testing.assert_allclose(between, table.displacements[3], atol=1e-12)


def test_the_store_returns_the_same_bits(monkeypatch, tmp_path):
    """From the file, made anew, or without a disk; what is spoilt is made anew."""
    for name, value in (('BEARINGS', 8), ('SELECTED_ACTIONS', 2), ('ROUNDS', (1,))):
        monkeypatch.setattr(value_iteration, name, value)
    # Not by the environment: what is compiled is not compiled again.
    monkeypatch.setattr(store, 'cache_directory', lambda: PrivateFolder(tmp_path))
    arrays = []
    for kind in ('made', 'read', 'spoilt', 'no disk'):
        store.forget()
        if kind == 'spoilt':
            files = sorted(tmp_path.rglob('table-*.npz'))
            assert len(files) == 1 and not list(tmp_path.rglob('*.part'))
            files[0].write_bytes(b'PK spoilt')
        if kind == 'no disk':
            monkeypatch.setattr(store, 'cache_directory', lambda: None)
        arrays.append(store.load_primitives(BIN, ROBOT))
    store.forget()
    first = arrays[0]
    for other in arrays[1:]:
        assert other.table is not first.table
        np.testing.assert_array_equal(other.table.displacements, first.table.displacements)
        np.testing.assert_array_equal(other.cost_to_go.values, first.cost_to_go.values)
        assert other.table.face_points == first.table.face_points


def test_stored_primitives_of_other_names_or_shapes_are_made_anew(monkeypatch, tmp_path,
                                                                  primitives):
    """As those of another version, whole as they are."""
    folder = PrivateFolder(tmp_path)
    monkeypatch.setattr(store, 'cache_directory', lambda: folder)
    monkeypatch.setattr(store, 'build_table', lambda *_, **__: primitives.table)
    monkeypatch.setattr(store, 'solve_cost_to_go', lambda *_, **__: primitives.cost_to_go)
    store.forget()
    store.load_primitives(BIN, ROBOT)
    files = {path.name: folder.read(path.name) for path in tmp_path.glob('*.npz')}
    assert len(files) == 2
    for name, content in files.items():
        arrays = store._decoded(content)
        first = next(key for key in ('values', 'displacements') if key in arrays)
        for other in ({'banana': np.zeros(3)}, {**arrays, first: arrays[first][:-1]},
                      {**arrays, first: arrays[first][0]}):
            folder.write(name, store._encoded(other))
            store.forget()
            loaded = store.load_primitives(BIN, ROBOT)
            assert loaded.cost_to_go.values.shape == primitives.cost_to_go.values.shape
            assert folder.read(name) == content
    store.forget()


def test_what_another_process_is_making_is_waited_for(monkeypatch, tmp_path, primitives):
    """Nodes that start together make the primitives once."""
    monkeypatch.setattr(store, 'cache_directory', lambda: PrivateFolder(tmp_path))
    is_begun, may_end, made = threading.Event(), threading.Event(), []

    def build(*_, **__):
        made.append(None)
        is_begun.set()
        assert may_end.wait(TIMEOUT)
        return primitives.table

    monkeypatch.setattr(store, 'build_table', build)
    monkeypatch.setattr(store, 'solve_cost_to_go', lambda *_, **__: primitives.cost_to_go)
    store.forget()
    with futures.ThreadPoolExecutor(2) as pool:
        # Locks of files are between descriptors, so that threads are as good as processes.
        loaded = [pool.submit(store.load_primitives, BIN, ROBOT)]
        assert is_begun.wait(TIMEOUT)
        loaded.append(pool.submit(store.load_primitives, BIN, ROBOT))
        # Without a lock the second one would make them as well, at once.
        futures.wait(loaded[1:], timeout=0.2)
        may_end.set()
        first, second = (one.result() for one in loaded)
    store.forget()
    assert len(made) == 1
    np.testing.assert_array_equal(first.table.displacements, second.table.displacements)


def test_what_was_learned_of_friction_does_not_matter_to_the_store(primitives):
    """Tables are for a shape; the guesses are weighted by what is known."""
    learned = bin_(feet=4, friction=0.8, contact_friction_coefficient=0.2)
    assert store.load_primitives(learned, ROBOT).table.displacements is \
        store.load_primitives(BIN, ROBOT).table.displacements
