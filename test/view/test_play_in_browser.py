"""The command ``push play`` as its user meets it: a server, a browser, a mouse and keys."""

from contextlib import contextmanager
import os
from pathlib import Path
import re
import signal
import subprocess
import sys

from helpers.browser import open_browser
from helpers.extras import import_extra
import pytest

ROOT = Path(__file__).parents[2]
pytestmark = [pytest.mark.browser, pytest.mark.slow]


@contextmanager
def playing(scenario):
    """Run ``push play``; yield the address that it prints, and end it by Ctrl-C."""
    import_extra('aiohttp', 'play')
    words = [sys.executable, '-m', 'push_view.cli', scenario, '--no-browser', '--port', '0']
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=ROOT,
                          env={**os.environ, 'PYTHONPATH': str(ROOT)}) as process:
        try:
            yield re.search(r'http\S+', process.stdout.readline())[0]
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(300) == 0


@pytest.fixture(scope='module')
def browser():
    """One session, which all tests of this file go on with, and one browser."""
    with open_browser() as browser, playing('task_tap') as url:
        browser.open(url)
        browser.wait('app.canEdit && app.recording.end > 0.2')
        yield browser


def pose(browser, body):
    """Return where the page draws a body now."""
    return browser.run(f'return poseOf(app.recording.at(app.player.time), "{body}")')


def test_the_goal_is_dragged_and_the_object_brought_there(browser):
    """By its middle; the heading stays."""
    browser.run('app.player.setSpeed(10)')
    start = browser.run('return app.recording.latest("goal", Infinity).pose')
    browser.drag(start[:2], (start[0] + 0.3, start[1] + 0.1))
    goal = browser.wait('app.recording.goals.length > 1 && app.recording.goals[1].pose')
    assert goal == pytest.approx([start[0] + 0.3, start[1] + 0.1, start[2]], abs=0.02)
    browser.wait('app.recording.states.some(s => s.state === "push")')
    # The goal of before may have been reached, too.
    done = browser.wait('app.recording.states.filter(s => s.state === "done" '
                        '&& s.time > app.recording.goals[1].time).map(s => s.time)[0]')
    browser.wait(f'app.player.time >= {done} '
                 '&& document.getElementById("state").textContent === "done"')
    x, y, _ = pose(browser, 'object')
    assert (x, y) == pytest.approx(goal[:2], abs=0.02)
    browser.wait('document.getElementById("achieved").textContent.startsWith("time stands")')
    end = browser.run('return app.recording.end')
    # To where it is: elsewhere the robot may be in the way.
    browser.run('app.send({type: "displace", pose: arguments[0]})', pose(browser, 'object'))
    browser.wait(f'app.recording.end > {end} + 0.5')


def test_the_object_is_moved_and_a_wall_drawn(browser):
    """By the mouse; the wall keeps to the grid, a click removes it, and Ctrl-Z brings it back."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    count = browser.run('return app.recording.displacements.length')
    x, y, _ = pose(browser, 'object')
    browser.run('document.querySelector("input[value=object]").click()')
    browser.drag((x, y), (x, y - 0.6))
    moved = browser.wait(f'app.recording.displacements[{count}]')
    assert moved['after'][1] == pytest.approx(y - 0.6, abs=0.05)
    # Planning round a wall takes its time, which is not what this is about.
    browser.run('app.send({type: "run", paused: true})')
    browser.wait('!app.player.isPlaying')
    browser.run('document.querySelector("input[value=wall]").click()')
    browser.drag((x - 0.4, y + 0.8), (x + 0.4, y + 0.83))
    browser.wait('app.recording.maps.length === 2 && app.recording.maps[1].rows.length > 0')
    (x0, y0, x1, y1), = browser.wait('app.recording.walls.length && app.recording.walls')
    assert y0 == y1 and [x0, y0, x1] == pytest.approx([x - 0.4, y + 0.8, x + 0.4], abs=0.051)
    assert [10 * x0, 10 * y0, 10 * x1] == [round(10 * value) for value in (x0, y0, x1)]
    browser.click((0.5 * (x0 + x1), y0))
    browser.wait('!app.recording.walls.length')
    ActionChains(browser.driver).key_down(Keys.CONTROL).send_keys('z').key_up(
        Keys.CONTROL).perform()
    browser.wait('app.recording.walls.length')
    browser.run('document.getElementById("clear-walls").click()')
    browser.wait('!app.recording.walls.length && app.recording.maps.length === 5')
    browser.run('app.send({type: "run", paused: false})')


def test_keys_do_what_the_mouse_does(browser):
    """Pause, step, a goal 5 cm further that is rotated by 5 degrees, and play."""
    from selenium.webdriver.common.keys import Keys
    floor = browser.driver.find_element('id', 'floor')
    before = browser.run('return app.recording.latest("goal", Infinity).pose')
    count = browser.run('return app.recording.goals.length')
    floor.send_keys('1', Keys.ARROW_RIGHT, '[', Keys.ENTER)
    browser.wait(f'app.recording.goals.length === {count + 1}')
    after = browser.run('return app.recording.latest("goal", Infinity).pose')
    assert after == pytest.approx([before[0] + 0.05, before[1], before[2] + 0.0873], abs=1e-3)
    floor.send_keys(' ')
    browser.wait('!app.player.isPlaying')
    end = browser.wait('app.recording.end')
    floor.send_keys(',', ',')
    assert browser.run('return app.player.time < app.recording.end')
    floor.send_keys(' ')
    browser.wait(f'app.recording.end > {end} + 0.2')


def test_settings_reach_the_simulation(browser):
    """A slider of friction and a choice; what is refused is shown."""
    browser.run('const s = app.panel.inputs.get("friction.0"); s.value = 0.77;'
                's.dispatchEvent(new Event("change"))')
    browser.wait('Math.abs(app.recording.latest("truth", Infinity).friction[0] - 0.77) < 0.01')
    browser.run('app.send({type: "goal", pose: [1, 2]})')
    browser.wait('document.getElementById("message").textContent.includes("goal.pose")')
    browser.run('location.hash = "goal=1"')
    browser.wait('document.getElementById("message").textContent.includes("link.goal")')
    browser.run('location.hash = "scenario=task_tap&object=bin&friction.0=0.2"')
    browser.wait('app.recording.scene.object.radius > 0 && app.recording.end > 0.1')
    assert browser.run('return app.recording.latest("truth", Infinity).friction[0]') == 0.2
    browser.run('const s = document.querySelector("select[name=base]"); s.value = "late_02";'
                's.dispatchEvent(new Event("change"))')
    browser.wait('app.recording.scene.true_base.dead_time === 0.2 && app.recording.end > 0.1')
    browser.wait('document.getElementById("base").tBodies[0].rows[0].innerText'
                 '.replace(/\\s+/g, " ") === "dead time [s] 0.20 0.00 0.00"')
    assert browser.errors() == []


def test_controls_are_large_enough_and_explained(browser):
    """A finger hits each; each term has a tooltip; only states and refusals are read aloud."""
    small = browser.run("""
        const target = (e) => ["radio", "checkbox"].includes(e.type) ? e.closest("label") : e;
        return [...document.querySelectorAll("button, select, input, a, summary")].map(target)
          .filter((e) => e.offsetParent).map((e) => [e.outerHTML, e.getBoundingClientRect()])
          .filter(([, box]) => Math.min(box.width, box.height) < 24).map(([text]) => text)""")
    assert small == []
    assert browser.run('return [...document.querySelectorAll(".term")].filter(e => !e.title)'
                       '.map(e => e.textContent)') == []
    assert browser.run('return [...document.querySelectorAll("[aria-live], [role=status], '
                       '[role=alert], output")].map(e => e.id)') == ['state', 'message']
    browser.run('document.getElementById("hint-read").click()')
    assert browser.run('return document.getElementById("hint").hidden')


@pytest.mark.parametrize('sensors, place', [('own_camera', 'robot'), ('room_camera', 'room')])
def test_the_floor_that_a_camera_sees_is_drawn(browser, sensors, place):
    """Within its angle and distances, and nowhere else: on the robot, or from the room."""
    browser.run('const s = document.querySelector("select[name=sensors]"); s.value = arguments[0];'
                's.dispatchEvent(new Event("change"))', sensors)
    browser.wait(f'app.recording.scene.camera && app.recording.scene.camera.place === "{place}"'
                 ' && app.recording.end > 0.1')
    assert browser.errors() == []
    colors = """
        const r = app.recording, camera = r.scene.camera, f = app.floor, c = app.camera;
        const pose = cameraPose(camera, poseOf(r.at(r.end), 'robot'));
        c.center = pose.slice(0, 2); c.scale = 100;
        const points = [[0.9, 0.4], [0.9, 1.5], [1.1, 1.5], [-0.9, 1.5], [-1.1, 1.5]].map(
          ([part, length]) => c.toScreen(transform(pose, [
            length * Math.cos(part * camera.half_angle),
            length * Math.sin(part * camera.half_angle)])));
        const near = c.toScreen(transform(pose, [0.9 * camera.nearest, 0]));
        const read = () => { f.draw(r, r.end, null); return [...points, near].map(([x, y]) =>
          [...f.context.getImageData(c.ratio * x, c.ratio * y, 1, 1).data].join()); };
        const drawn = read();
        r.scene.camera = null;
        const plain = read();
        r.scene.camera = camera;
        return drawn.map((color, i) => color !== plain[i]);"""
    is_tinted = browser.run(colors)
    # That a script reads pixels, as no page does, is complained of.
    browser.errors()
    assert is_tinted[:5] == [True, True, False, True, False]
    # Nearer than the nearest distance nothing is seen; the camera in the room has none.
    assert is_tinted[5] is (place == 'room')
