"""A headless Chromium in a test's hands: W3C WebDriver by chromedriver, with Python's standard library alone."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # WebDriver's name for a reference to an element
KEYS = {
    "ArrowRight": "\ue014",
    "ArrowLeft": "\ue012",
    "ArrowUp": "\ue013",
    "ArrowDown": "\ue015",
    "Home": "\ue011",
    "End": "\ue010",
    "Tab": "\ue004",
    "Enter": "\ue007",
}


def missing():
    """Why there is no browser here, or None."""
    for program in ("chromium", "chromedriver"):
        if shutil.which(program) is None:
            return f"{program} is not installed; install the packages of scripts/packages.txt: ./scripts/setup test"
    return None


class Browser:
    """One browser with one tab. Everything that it asks of a network and writes on its console is kept."""

    def __init__(self, width=1200, height=900, dark=False):
        self.folder = tempfile.TemporaryDirectory()
        self.driver = subprocess.Popen(
            ["chromedriver", "--port=0", "--log-level=SEVERE"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                self.base = f"http://127.0.0.1:{line.split('port')[-1].strip(' .' + os.linesep)}"
                break
        arguments = [
            "--headless=new",
            "--disable-gpu",
            "--hide-scrollbars",
            f"--window-size={width},{height}",
            f"--user-data-dir={self.folder.name}",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-background-networking",
            "--force-device-scale-factor=1",
        ]
        if os.geteuid() == 0:
            arguments.append("--no-sandbox")  # Chromium refuses to run as root with it
        if dark:
            arguments.append("--force-dark-mode")
        wanted = {
            "goog:chromeOptions": {"args": arguments, "perfLoggingPrefs": {"enableNetwork": True}},
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
        }
        self.session = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        self.do("POST", "/url", {"url": "about:blank"})
        self.requests()  # those of its own first page

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self.base + path, data=data, method=method, headers={"Content-Type": "application/json"}
        )
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()) from error

    def do(self, method, path, body=None):
        return self.ask(method, f"/session/{self.session}{path}", body)

    def open(self, file):
        self.do("POST", "/url", {"url": file.resolve().as_uri()})

    def run(self, script, *arguments):
        """A script's `return`, as JSON."""
        return self.do("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, script, what, seconds=20):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if value := self.run(script):
                return value
            time.sleep(0.05)
        raise AssertionError(f"not within {seconds} s: {what}")

    def devtools(self, command, **parameters):
        return self.do("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def emulate(self, width=None, dark=None, media=""):
        if width:
            self.devtools(
                "Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False
            )
        features = [] if dark is None else [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.devtools("Emulation.setEmulatedMedia", media=media, features=features)
        # Plots follow their place a frame later.
        self.do(
            "POST",
            "/execute/async",
            {
                "script": "requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(arguments[0], 50)))",
                "args": [],
            },
        )

    def point_at(self, x, y):
        self.do(
            "POST",
            "/actions",
            {
                "actions": [
                    {
                        "type": "pointer",
                        "id": "mouse",
                        "parameters": {"pointerType": "mouse"},
                        "actions": [
                            {"type": "pointerMove", "duration": 0, "x": round(x) - 3, "y": round(y)},
                            {"type": "pointerMove", "duration": 50, "x": round(x), "y": round(y)},
                        ],
                    }
                ]
            },
        )

    def mouse(self, *steps):
        """Steps of the left button: a place to move to, "pointerDown" or "pointerUp"."""
        actions = [
            {"type": step, "button": 0}
            if isinstance(step, str)
            else {"type": "pointerMove", "duration": 20, "x": round(step[0]), "y": round(step[1])}
            for step in steps
        ]
        mouse = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}
        self.do("POST", "/actions", {"actions": [mouse]})

    def drag(self, start, end):
        between = [(start[0] + end[0]) / 2, (start[1] + end[1]) / 2]
        self.mouse(start, "pointerDown", between, end, "pointerUp")

    def double_click(self, x, y):
        self.mouse((x, y), "pointerDown", "pointerUp", "pointerDown", "pointerUp")

    def press(self, *names):
        keys = [KEYS.get(name, name) for name in names]
        self.do(
            "POST",
            "/actions",
            {
                "actions": [
                    {
                        "type": "key",
                        "id": "keys",
                        "actions": [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")],
                    }
                ]
            },
        )

    def console(self):
        """Its lines since the last call."""
        return [entry["message"] for entry in self.do("POST", "/se/log", {"type": "browser"})]

    def requests(self):
        """Addresses that were asked for since the last call, data: aside."""
        asked = []
        for entry in self.do("POST", "/se/log", {"type": "performance"}):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                address = message["params"]["request"]["url"]
                if not address.startswith("data:"):
                    asked.append(address)
        return asked

    def accessibility_tree(self):
        self.devtools("Accessibility.enable")
        return self.devtools("Accessibility.getFullAXTree")["nodes"]

    def picture(self):
        return base64.b64decode(self.do("GET", "/screenshot"))

    def fresh(self):
        """As it began: an empty page, nothing stored, nothing emulated, nothing in its logs."""
        self.do("POST", "/url", {"url": "about:blank"})
        self.devtools("Emulation.clearDeviceMetricsOverride")
        self.devtools("Emulation.setEmulatedMedia", media="", features=[])
        self.devtools("Storage.clearDataForOrigin", origin="*", storageTypes="all")
        self.console()
        self.requests()

    def close(self):
        try:
            self.do("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait(20)
            self.driver.stdout.close()
            self.folder.cleanup()
