"""The browser of the distribution, without a window, as a user's."""

import base64
from contextlib import contextmanager, ExitStack
import io

from benchmarks.page.chromium import open_chromium
from helpers.extras import import_extra
import pytest

# Longest wait for what a page does [s]; a busy machine may take a minute.
PATIENCE = 300.0


class Browser:
    """
    A browser that shows one page.

    :param driver: of selenium.
    """

    def __init__(self, driver):
        self.driver = driver

    def open(self, url, width=1280, height=900, **media):
        """Open a page at a size in pixels, with media features like ``prefers_color_scheme``."""
        self._command('Emulation.setDeviceMetricsOverride', width=width, height=height,
                      deviceScaleFactor=1, mobile=width < 600)
        features = [{'name': name.replace('_', '-'), 'value': value}
                    for name, value in media.items()]
        self._command('Emulation.setEmulatedMedia', features=features)
        self.driver.get(url)

    def run(self, script, *arguments):
        """Run JavaScript in the page and return its result."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, condition, message=''):
        """Wait until a JavaScript expression is true, and return its value."""
        from selenium.webdriver.support.ui import WebDriverWait
        return WebDriverWait(self.driver, PATIENCE, 0.1).until(
            lambda driver: driver.execute_script(f'return {condition}'), message or condition)

    def drag(self, start, end):
        """Drag on the floor from one place to another, both (x, y) in metres."""
        from selenium.webdriver.common.action_chains import ActionChains
        canvas = self.driver.find_element('id', 'floor')
        box = self.run('const r = arguments[0].getBoundingClientRect();'
                       'return [r.width, r.height]', canvas)
        moves = ActionChains(self.driver, duration=50)
        for point in (start, (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])), end):
            x, y = self.run('return app.camera.toScreen(arguments[0])', list(point))
            moves.move_to_element_with_offset(canvas, x - box[0] / 2, y - box[1] / 2)
            if point is start:
                moves.click_and_hold()
        moves.release().perform()

    def click(self, point):
        """Click on the floor at (x, y) in metres."""
        from selenium.webdriver.common.action_chains import ActionChains
        canvas = self.driver.find_element('id', 'floor')
        x, y = self.run('const r = arguments[0].getBoundingClientRect();'
                        'const [x, y] = app.camera.toScreen(arguments[1]);'
                        'return [x - r.width / 2, y - r.height / 2]', canvas, list(point))
        ActionChains(self.driver).move_to_element_with_offset(canvas, x, y).click().perform()

    def picture(self):
        """Return what is on the screen as a picture of pillow."""
        from PIL import Image
        data = self._command('Page.captureScreenshot', format='png')['data']
        return Image.open(io.BytesIO(base64.b64decode(data))).convert('RGB')

    def errors(self):
        """List what the page has complained of since the last call."""
        return [entry['message'] for entry in self.driver.get_log('browser')
                if entry['level'] in ('SEVERE', 'WARNING')]

    def _command(self, name, **arguments):
        return self.driver.execute_cdp_cmd(name, arguments)


@contextmanager
def open_browser():
    """Start a browser; skip the test where there is none."""
    import_extra('selenium', 'test')
    with ExitStack() as stack:
        try:
            chrome = stack.enter_context(open_chromium())
        except FileNotFoundError as error:
            pytest.skip(str(error))
        yield Browser(chrome)
