"""The watch over a base that is calibrated: good and poor bases pass, dangerous ones do not."""

import dataclasses

from benchmarks.calibration.bases import calibrate, draw_base, simulation_of
from push_base.calibration.estimation import estimate
from push_base.calibration.findings import find_faults, Finding
from push_base.calibration.motion_watch import MotionWatch
from push_base.calibration.program import CalibrationProgram
from push_base.calibration.recording import Interruption
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_sim_node.drive_imperfections import DriveImperfections
from push_sim_node.sensors import SensorSettings
import pytest

ROBOT = RoundRobot(0.17, max_speed=0.5, max_yaw_rate=1.9, max_acceleration=0.9)
PERIOD = 0.02


def drive(velocity_of, commands):
    """Watch a base; return the first fault and when it was noticed."""
    watch = MotionWatch(ROBOT)
    for k, command in enumerate(commands):
        watch.add_command(k * PERIOD, command)
        fault = watch.check((k + 1) * PERIOD, velocity_of((k + 1) * PERIOD))
        if fault is not None:
            return fault, k * PERIOD
    return None


def test_a_base_that_does_not_stop_is_noticed():
    """Within two seconds after the zero, and named so."""
    commands = [Twist(0.3, 0.0, 0.0)] * 50 + [STOP] * 200
    fault, time = drive(lambda t: Twist(0.3, 0.0, 0.0), commands)
    assert fault is Interruption.NO_STOP
    assert 1.0 + 1.0 < time < 1.0 + 2.0


@pytest.mark.parametrize('velocity, fault', [
    (Twist(0.8, 0.0, 0.0), Interruption.RUNAWAY),
    (Twist(-0.3, 0.0, 0.0), Interruption.WRONG_MOTION),
    (Twist(0.3, 0.3, 0.0), Interruption.WRONG_MOTION),
    (Twist(0.3, 0.0, 1.0), Interruption.WRONG_MOTION)])
def test_another_motion_is_noticed_at_once(velocity, fault):
    """Within a third of a second."""
    found, time = drive(lambda t: velocity, [Twist(0.3, 0.0, 0.0)] * 50)
    assert found is fault
    assert time < 0.34


def test_one_wrong_message_is_no_fault():
    """Whatever it says."""
    assert drive(lambda t: Twist(5.0 if 0.4 < t < 0.43 else 0.3, 0.0, 0.0),
                 [Twist(0.3, 0.0, 0.0)] * 50) is None


def changed_from(time, change):
    """Calibrate a good base whose odometry is changed from some time on."""
    base = draw_base(0)._replace(nominal=ROBOT, robot=ROBOT, imperfections=DriveImperfections(),
                                 sensors=SensorSettings())
    simulation, program = simulation_of(base), CalibrationProgram(ROBOT)
    while not program.is_done:
        measured = simulation.next_measurement()
        if isinstance(measured, Odometry):
            now = simulation.time
            simulation.command(program.step(now, change(measured) if now > time else measured))
    return program


@pytest.mark.slow
@pytest.mark.parametrize('time', [25.0, 55.0])
def test_a_base_that_fails_in_the_middle_is_stopped_and_named(time):
    """Long after the first blocks: it moves the other way."""
    program = changed_from(time, lambda odometry: odometry._replace(
        twist=Twist(*(-value for value in odometry.twist))))
    assert program.recording.commands[-1].time < time + 5.0
    assert program.recording.commands[-1].twist == STOP
    assert find_faults(estimate(program.recording)) == [Finding.WRONG_MOTION]


@pytest.mark.slow
@pytest.mark.parametrize('drive_kind', ['differential', 'holonomic'])
def test_a_poor_base_is_measured_to_the_end(drive_kind):
    """Late, with a smoother, uneven wheels and a dead band at once."""
    base = draw_base(0 if drive_kind == 'differential' else 1)
    robot = dataclasses.replace(base.robot, dead_time=0.45, time_constant=0.3)
    poor = base._replace(robot=robot, imperfections=DriveImperfections(
        smoother_acceleration=0.3, output_min_speed=0.09,
        left_wheel_factor=0.9 if drive_kind == 'differential' else 1.0))
    assert calibrate(poor).recording.interruption is None
