"""Preparation of objects in a process of its own: its progress, its end, and what it leaves."""

import asyncio
import dataclasses
import multiprocessing

from helpers.objects import bin_, box
from push_model.parameters import PushedObject
from push_planner.straight import planner
from push_scenario.definition.loader import load_scenario
from push_view.live.preparation import Job, prepare
from push_view.live.session import Session
from push_view.live.setup import Setup
from push_view.server.message_log import MessageLog
import pytest

JOB = Job.of(Setup.of(load_scenario('task_tap')))
# A robot for which nothing has been prepared.
OTHER = JOB._replace(robot=dataclasses.replace(JOB.robot, radius=0.173))


def wait_for_children():
    """Wait until the process that was told to end has ended."""
    for child in multiprocessing.active_children():
        child.join(300.0)
    assert not multiprocessing.active_children()


@pytest.mark.parametrize('obj', [box(), bin_(feet=4)], ids=['box', 'bin'])
def test_a_session_asks_for_what_a_run_loads(
        obj: PushedObject, monkeypatch: pytest.MonkeyPatch) -> None:
    """The costs of a task are those that it counts in the table of its planner."""
    scenario = dataclasses.replace(load_scenario('task_demo'), object=obj, true_object=obj)
    monkeypatch.setattr(planner, 'load_primitives', lambda obj, robot, settings, belief: settings)
    session = Session(Setup.of(scenario), MessageLog())
    supervisor = session._run._robot.supervisor
    while supervisor.plan_request is None:
        session.advance(0.0)
    costs = planner.primitives_for(supervisor.plan_request, scenario.robot, scenario.task.drive)
    assert costs == Job.of(session.setup).costs


@pytest.mark.slow
def test_what_was_prepared_is_done():
    """Its progress comes in order; once it is done nothing is left to do."""
    parts = []
    asyncio.run(prepare([JOB], lambda name, part: parts.append((name, part))))
    assert JOB.is_done
    assert parts[0] == ('box 04', 0.0) and parts == sorted(parts)
    wait_for_children()


@pytest.mark.slow
def test_preparation_ends_at_once_where_nobody_waits():
    """Cancelled at its first sign of life it leaves neither a process nor a file."""
    async def run():
        started = asyncio.Event()
        task = asyncio.create_task(prepare([OTHER], lambda name, part: started.set()))
        await started.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        wait_for_children()

    asyncio.run(run())
    assert not OTHER.is_done
