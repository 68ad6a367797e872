"""The server of the page: whom it serves, whom it refuses, and what it survives."""

import asyncio
import json

from helpers.extras import import_extra
from push_view.server.commands import parse_command
from push_view.server.message_log import MessageLog
import pytest

aiohttp = import_extra('aiohttp', 'play')
TestClient = import_extra('aiohttp', 'play', 'aiohttp.test_utils').TestClient
TestServer = import_extra('aiohttp', 'play', 'aiohttp.test_utils').TestServer
server = import_extra('aiohttp', 'play', 'push_view.server.page_server')
serving = import_extra('aiohttp', 'play', 'push_view.server.serving')


class Page:
    """
    A client of a server that notes the commands it is sent.

    :param client: of aiohttp.
    :param counts: numbers of pages that the session was told of.
    """

    def __init__(self, client, page_server, log, commands, counts):
        self.counts = counts
        self.client = client
        self.server = page_server
        self.log = log
        self.commands = commands

    @property
    def origin(self):
        """Origin of the page itself."""
        return f'http://{self.client.host}:{self.client.port}'

    async def socket(self, path='/socket', **headers):
        """Connect as the page does, unless other headers are named."""
        return await self.client.ws_connect(path, headers={'Origin': self.origin, **headers})


def with_page(play, token=None, origin=None):
    """Run a coroutine function on the ``Page`` of a new server."""
    async def run():
        log, commands, counts = MessageLog(), [], []

        async def handle(text):
            commands.append(parse_command(text))

        page_server = server.PageServer('a run', log, server.Callbacks(
            handle, counts.append, lambda: 'goal: {}'), server.Access(token, origin))
        async with TestClient(TestServer(page_server.application())) as client:
            return await play(Page(client, page_server, log, commands, counts))

    return asyncio.run(run())


def test_the_page_comes_whole_and_shows_what_is_logged():
    """One file with its title; then what was logged before and after the connection."""
    async def play(page):
        answer = await page.client.get('/')
        text = await answer.text()
        assert answer.status == 200 and '<title>a run</title>' in text and 'src=' not in text
        assert answer.headers['X-Frame-Options'] == 'DENY'
        page.log.add({'type': 'scene'})
        socket = await page.socket()
        assert await socket.receive_json() == [{'type': 'scene'}]
        page.log.add({'type': 'goal'})
        assert await socket.receive_json() == [{'type': 'goal'}]

    with_page(play)


def test_a_bad_command_is_refused_and_counted_and_the_next_one_taken():
    """Each with its reason; the connection stays."""
    async def play(page):
        socket = await page.socket()
        for number, bad in enumerate(['{', '{"type": "jump"}', '{"type": "goal"}'], 1):
            await socket.send_str(bad)
            refusal, = await socket.receive_json()
            assert (refusal['type'], refusal['count']) == ('refused', number)
        await socket.send_bytes(b'goal')
        assert 'expected text' in (await socket.receive_json())[0]['text']
        await socket.send_str('{"type": "step"}')
        await socket.send_str('{"type": "jump"}')
        assert (await socket.receive_json())[0]['count'] == page.server.refused == 5
        assert page.commands == [parse_command('{"type": "step"}')]

    with_page(play)


def test_who_sends_nothing_but_nonsense_is_disconnected():
    """After a hundred commands, or one that is far too long; others are served."""
    async def play(page):
        nonsense, lengthy = await page.socket(), await page.socket()
        for _ in range(server.MAX_REFUSALS):
            await nonsense.send_str('?')
        await lengthy.send_str(json.dumps({'type': 'x' * server.MAX_COMMAND}))
        for socket in (nonsense, lengthy):
            while not socket.closed:
                await socket.receive(timeout=300.0)
        assert not page.commands
        other = await page.socket()
        await other.send_str('{"type": "step"}')
        await other.send_str('?')
        await other.receive_json()
        assert len(page.commands) == 1

    with_page(play)


@pytest.mark.parametrize('headers', [
    {'Origin': 'http://elsewhere.example'}, {'Origin': 'null'}, {'Origin': ''},
    {'Origin': 'http://elsewhere.example', 'Host': 'elsewhere.example'}])
def test_a_page_elsewhere_cannot_command(headers):
    """Nor one that has this machine under its own name."""
    async def play(page):
        with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
            await page.socket(**headers)
        assert refusal.value.status == 403
        if 'Host' in headers:
            assert (await page.client.get('/', headers=headers)).status == 403

    with_page(play)


def test_who_states_no_origin_cannot_command():
    """As programs that are no browser: behind a proxy or not."""
    async def play(page):
        with pytest.raises(aiohttp.WSServerHandshakeError) as refusal:
            await page.client.ws_connect('/socket?token=secret')
        assert refusal.value.status == 403

    with_page(play)
    with_page(play, token='secret')
    with_page(play, token='secret', origin='https://robot.example')


def test_others_need_the_token():
    """In the address, for page and commands."""
    async def play(page):
        for query in ('', '?token=', '?token=wrong', '?token=secre', '?token=%ff'):
            assert (await page.client.get('/' + query)).status == 403
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await page.socket('/socket' + query)
        assert (await page.client.get('/?token=secret')).status == 200
        assert not (await page.socket('/socket?token=secret')).closed
        with pytest.raises(aiohttp.WSServerHandshakeError):
            await page.socket('/socket?token=secret', Origin='http://elsewhere.example')

    with_page(play, token='secret')


def test_a_page_behind_a_proxy_commands_under_its_own_address():
    """And under no other that is not the server's."""
    async def play(page):
        path = '/socket?token=secret'
        for origin in (page.origin, 'https://robot.example'):
            assert not (await page.socket(path, Origin=origin)).closed
        for origin in ('http://robot.example', 'https://robot.example.evil', 'null'):
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await page.socket(path, Origin=origin)

    with_page(play, token='secret', origin='https://robot.example')


def test_a_session_is_told_how_many_pages_there_are():
    """Until the last one is closed."""
    async def play(page):
        sockets = [await page.socket(), await page.socket()]
        for socket in sockets:
            await socket.close()
        while page.counts[-1]:
            await asyncio.sleep(0.0)
        assert page.counts == [1, 2, 1, 0]

    with_page(play)


def test_the_scenario_is_downloaded_by_those_who_see_the_page():
    """As a file."""
    async def play(page):
        answer = await page.client.get('/scenario.yaml?token=secret')
        assert (answer.status, await answer.text()) == (200, 'goal: {}')
        assert 'attachment' in answer.headers['Content-Disposition']
        assert (await page.client.get('/scenario.yaml')).status == 403

    with_page(play, token='secret')


def test_an_address_is_served_while_it_is_needed():
    """Then the port is free again; one that is taken is an error."""
    async def run():
        async def handle(text):
            pass

        options = {'host': '127.0.0.1', 'access': server.Access()}
        callbacks = server.Callbacks(handle)
        async with serving.serve('a run', MessageLog(), callbacks, port=0, **options) as url:
            port = int(url.rstrip('/').rpartition(':')[2])
            async with aiohttp.ClientSession() as session:
                async with session.get(url) as answer:
                    assert answer.status == 200
            with pytest.raises(OSError):
                async with serving.serve('two', MessageLog(), callbacks, port=port, **options):
                    pass
        async with serving.serve('a run', MessageLog(), callbacks, port=port, **options) as again:
            assert again == url

    asyncio.run(run())


def test_a_connection_that_asks_for_nothing_is_closed(monkeypatch):
    """Half a request is none; who asks is served."""
    monkeypatch.setattr(serving, 'IDLE_TIME', 0.3)

    async def play():
        callbacks = server.Callbacks(lambda text: asyncio.sleep(0.0))
        async with serving.serve('a run', MessageLog(), callbacks, host='127.0.0.1', port=0,
                                 access=server.Access()) as address:
            port = int(address.rstrip('/').rpartition(':')[2])
            for sent in (b'', b'GET / HT'):
                reader, writer = await asyncio.open_connection('127.0.0.1', port)
                writer.write(sent)
                assert await reader.read() == b''
                writer.close()
            async with aiohttp.ClientSession() as session, session.get(address) as answer:
                assert answer.status == 200

    asyncio.run(play())
