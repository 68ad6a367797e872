"""
Draw the pictures of the page in the docs.

``python -m benchmarks.page.picture docs/page.png`` draws a task, and with ``docs/page_room.png
room`` behind it a room with several objects in the middle of a move.

A session of ``push play`` runs the demonstration with another goal and a wall; once it has come
to its end, the page is shown in the middle of the second push. The picture ends below a section of
the right column, so that none is cut.
"""

import base64
from collections.abc import Generator
import contextlib
from pathlib import Path
import sys
import time
from typing import Any

from benchmarks.page.benchmark import playing, wait_for
from benchmarks.page.chromium import open_chromium

SCENARIO = 'task_demo'
# The room, when it is shown [s], and the size of that picture [pixels].
ROOM, ROOM_TIME = 'blocked_door', 86.0
ROOM_SIZE = 1240, 790
# Size of the picture, of which the height follows from the sections that it shows, and of the
# window while the task runs, as what is painted meanwhile nobody looks at [pixels].
WIDTH, HEIGHT = 1240, 800
SMALL_WIDTH, SMALL_HEIGHT = 400, 300
# Longest wait for the end of the task [s]; chosen: that of a very busy machine.
PATIENCE = 3600.0
# Another goal than that of the scenario, and a wall beside the way there [m, m, rad].
GOAL = [1.1, 0.6, -0.35]
WALL = {'start': [0.55, 0.0], 'end': [0.55, -0.6]}
# Number of the push that is shown, and how much of its duration is over.
PUSH, FRACTION = 1, 0.5
# What the last section in the picture holds, and the margin below that section [pixels].
LAST_SECTION, MARGIN = 'values', 8


def main(path: str) -> None:
    """
    Draw the picture.

    :param path: of the PNG file to write.
    """
    with _page(SCENARIO) as driver:
        _play(driver)
        _set_size(driver, WIDTH, HEIGHT)
        driver.execute_script('document.getElementById("hint-read").click()')
        wait_for(driver, 'document.getElementById("background").hidden', PATIENCE)
        _show_push(driver)
        height = driver.execute_script(
            'return document.getElementById(arguments[0]).closest("section")'
            '.getBoundingClientRect().bottom + window.scrollY', LAST_SECTION)
        _set_size(driver, WIDTH, round(height) + MARGIN)
        _save(driver, path)


def draw_room(path: str) -> None:
    """
    Draw the picture of several objects.

    :param path: of the PNG file to write.
    """
    with _page('--room', ROOM) as driver:
        _set_size(driver, *ROOM_SIZE)
        driver.execute_script('document.getElementById("hint-read").click();'
                              'app.player.setSpeed(10);')
        wait_for(driver, f'app.recording.end > {ROOM_TIME}', PATIENCE)
        driver.execute_script('app.player.seek(arguments[0]); app.camera.fit(app.recording);'
                              'app.redraw();', ROOM_TIME)
        _save(driver, path)


@contextlib.contextmanager
def _page(*scene: str) -> Generator[Any, None, None]:
    """Open a small page inside this context, once it shows something; return its driver."""
    with playing(*scene) as url, open_chromium() as driver:
        _set_size(driver, SMALL_WIDTH, SMALL_HEIGHT)
        driver.get(url)
        wait_for(driver, 'typeof app !== "undefined" && app.canEdit && app.recording.end > 0.2')
        yield driver


def _save(driver: Any, path: str) -> None:
    """Write what the page shows to a PNG file."""
    # One frame to lay the page out, one to paint it.
    time.sleep(1.0)
    shot = driver.execute_cdp_cmd('Page.captureScreenshot', {'format': 'png'})
    Path(path).write_bytes(base64.b64decode(shot['data']))


def _set_size(driver: Any, width: int, height: int) -> None:
    """Set the size of the window [pixels]."""
    driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
        'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': False})


def _play(driver: Any) -> None:
    """Give the wall and the goal, and let the task run to its end."""
    driver.execute_script('app.send({type: "wall", ...arguments[0]});'
                          'app.send({type: "goal", pose: arguments[1]});'
                          'app.player.setSpeed(10);', WALL, GOAL)
    wait_for(driver, '["done", "failed"].includes((app.recording.states.at(-1) || {}).state)',
             PATIENCE)


def _show_push(driver: Any) -> None:
    """Seek a time within a push, and show the whole floor."""
    driver.execute_script(
        'const push = app.recording.pushes()[arguments[0]];'
        'app.player.seek(push.start + arguments[1] * (push.end - push.start));'
        'app.camera.fit(app.recording); app.redraw();', PUSH, FRACTION)


if __name__ == '__main__':
    (draw_room if sys.argv[2:] == ['room'] else main)(sys.argv[1])
