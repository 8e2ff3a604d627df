"""A run with --view in a test's hands, over plain sockets or in a browser."""

import http.client
import json
import re
import socket
import subprocess
import time
from urllib.parse import parse_qs, urlsplit

from capsoc_tools import browser
from harness import CAPSOC, CLEAN, Case

#: A main job that is over soon.
SHORT = ("-P", "demodulation_samples=2000", "-P", "calibration_samples=200")

#: How many pixels of a canvas are drawn on.
PAINTED = """
const canvas = document.getElementById(arguments[0]), copy = new OffscreenCanvas(canvas.width, canvas.height);
const pen = copy.getContext('2d', {willReadFrequently: true});
pen.drawImage(canvas, 0, 0);
const pixels = pen.getImageData(0, 0, canvas.width, canvas.height).data;
let count = 0;
for (let i = 3; i < pixels.length; i += 4) count += pixels[i] > 0;
return count;
"""


class Events:
    """One stream of server-sent events."""

    def __init__(self, view, receive_buffer=0):
        view.case.addCleanup(self.close)
        self.connection = http.client.HTTPConnection("127.0.0.1", view.port, timeout=30)
        if receive_buffer:
            self.connection.sock = socket.socket()
            self.connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
            self.connection.sock.connect(("127.0.0.1", view.port))
        self.connection.request("GET", f"/events?token={view.token}")
        self.answer = self.connection.getresponse()
        assert self.answer.status == 200, self.answer.status

    def next(self):
        """(kind, frame) of the next event."""
        kind = None
        while line := self.answer.readline():
            name, _, value = line.decode().rstrip("\n").partition(": ")
            if name == "event":
                kind = value
            elif name == "data":
                return kind, json.loads(value)
        raise EOFError

    def until(self, holds, seconds=30):
        """All frames up to the first for which something holds."""
        frames, end = [], time.monotonic() + seconds
        while time.monotonic() < end:
            frames.append(self.next()[1])
            if holds(frames[-1]):
                return frames
        raise AssertionError(f"not within {seconds} s; the last frame: {str(frames[-1])[:2000]}")

    def close(self):
        self.answer.close()
        self.connection.close()


class View:
    """A process of capsoc with a page."""

    def __init__(self, case, *arguments, command="run"):
        options = ["--view"] if command == "run" else []
        self.case = case
        self.process = case.start(command, *arguments, *options)
        self.said = ""
        while not (found := re.search(r"view: (http://\S+)\n", self.said)):
            line = self.process.stderr.readline().decode()
            assert line, f"no page: {self.said}"
            self.said += line
        self.url = found[1]
        self.port = urlsplit(self.url).port
        self.token = parse_qs(urlsplit(self.url).query)["token"][0]

    def ask(self, method, path, body=None, headers=None):
        """(status, text, headers) of one request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request(method, path, body, headers or {})
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text, answer.headers

    def post(self, body, **headers):
        """A command as text, with the token."""
        return self.ask("POST", "/do", body, {"X-Capsoc-Token": self.token, **headers})

    def tell(self, what, **more):
        """A command's number."""
        status, text, _ = self.post(json.dumps({"do": what, **more}))
        assert status == 202, text
        return json.loads(text)["command"]

    def do(self, events, what, **more):
        """The first frame after a command was carried out."""
        number = self.tell(what, **more)
        return events.until(lambda frame: frame["command"] >= number)[-1]

    def end(self):
        """(exit code, standard output, standard error) after the page ended the run."""
        self.tell("end")
        out, said = self.process.communicate(timeout=60)
        return self.process.returncode, out.decode(), self.said + said.decode()


class ViewCase(Case):
    """A test of a run with a page."""

    def view(self, *arguments, **keywords):
        return View(self, *arguments, **keywords)

    def run_plain(self, *arguments, code=0):
        """(standard output, standard error) of capsoc."""
        done = subprocess.run(
            [CAPSOC, *map(str, arguments)],
            cwd=self.folder,
            env=CLEAN,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout, done.stderr


class Browsed(ViewCase):
    """A test of a page in one browser."""

    def setUp(self):
        super().setUp()
        if reason := browser.missing():
            self.fail(reason)
        self.browser = browser.Browser()
        self.addCleanup(self.browser.close)

    def open(self, view):
        self.browser.do("POST", "/url", {"url": view.url})
        self.browser.wait("return document.documentElement.dataset.mode", "a frame is there")

    def mode(self, mode):
        self.browser.wait(f"return document.documentElement.dataset.mode === '{mode}'", f"the run is {mode}")

    def text(self, name):
        return self.browser.run("return document.getElementById(arguments[0]).textContent", name)

    def painted(self, name):
        return self.browser.run(PAINTED, name)

    def press(self, name, *keys):
        """Keys on an element that has the focus."""
        self.browser.run("document.getElementById(arguments[0]).focus()", name)
        self.browser.press(*keys)

    def check_clean(self, view):
        """Nothing complained, and nothing else was asked for."""
        self.assertEqual(self.browser.console(), [])
        for address in self.browser.requests():
            self.assertTrue(address.startswith(f"http://127.0.0.1:{view.port}/"), address)
