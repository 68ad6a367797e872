"""The report as its reader sees it: in a browser, from disk."""

import dataclasses

from helpers.browser import open_browser
from helpers.tapes import make_result, make_tape, straight_plan, TIMES
import numpy as np
from push_model.geometry import Pose
from push_model.plan_request import PlanFailure
from push_navigation.map_clearance import PositionEllipse
from push_planner.refusal_marks import FaceMark, NarrowPlace, RefusalMarks
from push_view import write_report
from push_view.messages import later_push, refusal_message
from push_view.page_file import page_html
from push_view.recording import recording
import pytest

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope='module')
def browser():
    """One browser for all tests of this file."""
    with open_browser() as browser:
        yield browser


@pytest.fixture(scope='module')
def url(tmp_path_factory):
    """Write a report of two runs, of which the second goes half as far."""
    path = tmp_path_factory.mktemp('report') / 'push.html'
    runs = [make_result(make_tape(object_x=speed * TIMES, robot_x=speed * TIMES - 0.38, mode=1.0,
                                  force_n=3.0, contact_x=speed * TIMES - 0.2),
                        straight_plan(), (2.0, 0.0, 0.0)) for speed in (0.2, 0.1)]
    write_report([runs[0], dataclasses.replace(runs[1], control_law='open_loop')], path)
    return path.as_uri()


def object_x(browser):
    """Return where the page draws the object."""
    return browser.run("return app.recording.at(app.player.time)('object_x')")


def test_a_report_plays_steps_and_jumps(browser, url):
    """By buttons, keys, its time and its events; nothing is complained of."""
    browser.open(url, prefers_reduced_motion='reduce')
    browser.wait('app.recording.time.length > 0')
    assert browser.run('return app.player.isPlaying') is False
    browser.run('document.getElementById("play").click()')
    browser.wait('app.player.time > 0.05')
    browser.run('app.player.seek(5)')
    assert object_x(browser) == pytest.approx(1.0, abs=1e-6)
    body = browser.driver.find_element('tag name', 'body')
    body.send_keys('.')
    assert object_x(browser) == pytest.approx(1.004, abs=1e-6)
    body.send_keys(',')
    assert object_x(browser) == pytest.approx(1.0, abs=1e-6)
    browser.run('document.querySelector("#events button:last-child").click();'
                '[...document.querySelectorAll("#events button")].pop().click()')
    assert browser.run('return app.player.time') == pytest.approx(9.0)
    assert browser.wait('document.getElementById("state").textContent === "done"')
    assert browser.errors() == []


def test_another_run_is_chosen(browser, url):
    """The second one goes half as far, and so misses the goal; the first is its ghost."""
    browser.open(url, prefers_reduced_motion='reduce')
    browser.wait('app.recording.time.length > 0')
    browser.run('const run = document.getElementById("run"); run.value = 1;'
                'run.dispatchEvent(new Event("change")); app.player.seek(10)')
    assert object_x(browser) == pytest.approx(1.0, abs=1e-6)
    browser.wait('!app.panel.isLate(app.recording)')
    ghost = browser.run("return app.recording.shownGhost.at(5)('object_x')")
    assert ghost == pytest.approx(1.0, abs=1e-6)
    browser.run('document.getElementById("ghost").click()')
    assert browser.run('return app.recording.shownGhost') is None
    assert browser.wait('document.getElementById("state").textContent === "missed the goal"')
    assert 'position error 1000.0 mm, bound 10.0 mm' in browser.run(
        'return document.getElementById("reason").textContent')
    assert browser.run('return document.getElementById("state").dataset.state') == 'missed'


@pytest.mark.parametrize('scheme', ['light', 'dark'])
def test_a_small_screen_shows_all_without_scrolling_sideways(browser, url, scheme):
    """At 380 pixels; text and ground contrast, in grey too."""
    browser.open(url, 380, 800, prefers_color_scheme=scheme, prefers_reduced_motion='reduce')
    browser.wait('app.recording.time.length > 0 && app.camera.isFitted')
    assert browser.run('return document.documentElement.scrollWidth') <= 380
    small = browser.run('return [...document.querySelectorAll("button, select")].filter('
                        'e => e.offsetParent && e.getBoundingClientRect().height < 28).length')
    assert small == 0
    brightness = np.asarray(browser.picture().convert('L'), dtype=float)
    ground = np.median(brightness)
    assert ground > 230 if scheme == 'light' else ground < 60
    assert np.abs(brightness - ground).max() > 150


def test_what_matters_differs_in_grey(browser, url):
    """Colours of object, goal and belief differ from the ground by 3 to 1, as WCAG asks."""
    for scheme in ('light', 'dark'):
        browser.open(url, prefers_color_scheme=scheme)
        browser.wait('app.recording.time.length > 0')
        colors = browser.run('return themeColors()')
        ground = luminance(colors['paper'])
        for name in ('object', 'goal', 'believed', 'force', 'cone', 'plan', 'robot', 'faint'):
            high, low = sorted((luminance(colors[name]), ground), reverse=True)
            assert (high + 0.05) / (low + 0.05) > 3.0, (scheme, name)


def luminance(color):
    """Relative luminance of a colour ``#rrggbb``, as WCAG 2.1 defines it."""
    channels = np.array([int(color[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(channels <= 0.03928, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def test_a_report_draws_what_is_planned_and_why_there_is_no_plan(browser, tmp_path):
    """Ghosts with their numbers, and the marks of a refusal, until there is a plan again."""
    path, runs = tmp_path / 'planned.html', []
    marks = RefusalMarks(NarrowPlace(1.0, 0.0, 0.5, 0.8, PositionEllipse(0.2, 0.1, 0.3)),
                         (FaceMark(0.4, 0.5, False), FaceMark(0.4, -0.5, True)),
                         Pose(1.5, 0.5, 0.1), Pose(1.2, 0.0, 0.0))
    messages = recording(make_result(make_tape(), straight_plan(), (2.0, 0.0, 0.0)))
    later = [later_push(Pose(1.0 + x, 0.3, 0.2), Pose(0.7 + x, 0.2, 0.2)) for x in (0.0, 0.5)]
    for message in messages:
        runs.append({**message, 'later': later} if message['type'] == 'plan' else message)
    runs.append(refusal_message(5.0, PlanFailure.BLOCKED, 'a wall', marks))
    path.write_text(page_html('planned', {
        'runs': [{'name': 'one', 'messages': runs}], 'table': [['']]}), encoding='utf-8')
    browser.open(path.as_uri(), prefers_reduced_motion='reduce')
    browser.wait('app.recording.time.length > 0')
    browser.run('const c = app.floor.context, draw = c.fillText.bind(c); window.texts = [];'
                'c.fillText = (text, ...at) => { window.texts.push(text); draw(text, ...at); };')
    for time, shown, hidden in ((1.0, '3', '0.50 m free, 0.80 m needed'),
                                (6.0, '0.50 m free, 0.80 m needed', '3')):
        browser.run(f'window.texts = []; app.player.seek({time}); app.redraw();')
        browser.wait(f'window.texts.includes("{shown}")')
        assert not browser.run(f'return window.texts.includes("{hidden}")')
    assert browser.errors() == []
