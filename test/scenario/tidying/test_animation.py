"""The animation of a room shows what is planned at each move, and where all are at the end."""

from pathlib import Path

from helpers.tapes import make_tape, TIMES
import numpy as np
from PIL import Image
from push_model.files.data import share_directory
from push_model.files.parameter_files import files_by_name
from push_planner.rearrangement.order import plan_order
from push_planner.rearrangement.problem import OrderPlan, Rearrangement
from push_scenario.simulation.result import Outcome, RunResult
from push_scenario.tidying import animation
from push_scenario.tidying.room import read_room
from push_scenario.tidying.tidy import MoveResult, tidy, TidyProgress, TidyResult
import pytest


@pytest.mark.slow
def test_a_room_is_shown_move_by_move(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One frame each two seconds of every move, and some that hold the end; each move is seen."""
    monkeypatch.setattr(animation, 'FINAL_FRAMES', 2)
    room = read_room(files_by_name(share_directory() / 'config' / 'rooms')['swap'])
    plans: list[OrderPlan] = []

    def plan_only(problem: Rearrangement) -> OrderPlan:
        plans.append(plan_order(problem))
        return plans[-1]._replace(moves=())

    start = tidy(room, find_order=plan_only)
    plan, = plans
    poses, moves = dict(start.poses), []
    for index, move in enumerate(plan.moves):
        moved = np.linspace(move.start[:2], move.end[:2], len(TIMES)).T
        run = RunResult(room.scenarios[move.name], 'feedback', Outcome.DONE, tape=make_tape(
            object_x=moved[0], object_y=moved[1], robot_x=moved[0] - 0.4, robot_y=moved[1]))
        progress = TidyProgress(plan._replace(moves=plan.moves[index:]), index, 3, dict(poses))
        moves.append(MoveResult(move, run, (), progress))
        poses[move.name] = move.end
    result = TidyResult(room, tuple(moves), poses, start.robot_pose, {})
    animation.draw_room_animation(result, tmp_path / 'room.gif')
    frames = []
    with Image.open(tmp_path / 'room.gif') as picture:
        for index in range(picture.n_frames):
            picture.seek(index)
            frames.append((np.asarray(picture.convert('L'), dtype=int), picture.info['duration']))
    count = len(plan.moves) * len(np.arange(TIMES[0], TIMES[-1], animation.FRAME_PERIOD))
    # Equal frames are stored once, for longer.
    assert sum(duration for _, duration in frames) >= 0.8 * frames[0][1] * (count + 2)
    assert all(np.abs(one - other).max() > 50
               for (one, _), (other, _) in zip(frames, frames[1:]))
