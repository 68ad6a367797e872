"""Chromium of the distribution, without a window."""

from collections.abc import Generator
import contextlib
import shutil
from typing import Any

BROWSERS = ('chromium', 'chromium-browser', 'google-chrome')
DRIVERS = ('chromedriver', 'chromium.chromedriver')
OPTIONS = ('--headless=new', '--no-sandbox', '--disable-dev-shm-usage', '--hide-scrollbars',
           '--disable-background-networking', '--no-first-run')


@contextlib.contextmanager
def open_chromium() -> Generator[Any, None, None]:
    """
    Start a browser inside this context.

    :return: driver of selenium.
    :raises FileNotFoundError: where there is no chromium, or no chromedriver.
    """
    program, driver = (next(filter(None, map(shutil.which, names)), None)
                       for names in (BROWSERS, DRIVERS))
    if program is None or driver is None:
        raise FileNotFoundError('no chromium with its chromedriver, which are packages of the '
                                'distribution')
    from selenium import webdriver
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    chrome = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        yield chrome
    finally:
        chrome.quit()
