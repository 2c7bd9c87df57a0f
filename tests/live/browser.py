"""Drives a headless Chromium over its pipe, with Python's own library alone (Chrome DevTools Protocol)."""
import json
import os
import subprocess
import time


class Browser:
    def __init__(self, program, folder):
        from_us, to_browser = os.pipe()
        from_browser, to_us = os.pipe()

        def take_places():  # the browser reads from 3 and writes to 4
            os.dup2(from_us, 10)
            os.dup2(to_us, 11)
            os.dup2(10, 3)
            os.dup2(11, 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
             f"--user-data-dir={folder}", "about:blank"], preexec_fn=take_places, close_fds=False,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(from_us)
        os.close(to_us)
        self.to, self.back = os.fdopen(to_browser, "wb", 0), os.fdopen(from_browser, "rb", 0)
        self.number, self.text, self.complaints = 0, b"", []
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.page = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log"]:
            self.ask(domain + ".enable")

    def receive(self):
        while b"\0" not in self.text:
            piece = os.read(self.back.fileno(), 65536)
            assert piece, "the browser has gone"
            self.text += piece
        message, self.text = self.text.split(b"\0", 1)
        return json.loads(message)

    def send(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        self.to.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled"):
                self.complaints.append(answer["params"])
            if answer.get("id") == self.number:
                assert "result" in answer, answer
                return answer["result"]

    def ask(self, method, **parameters):
        return self.send(method, self.page, **parameters)

    def value(self, script):
        """Returns the value of an expression on the page."""
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait_for(self, script, timeout=30):
        end = time.monotonic() + timeout
        while not self.value(script):
            assert time.monotonic() < end, script
            time.sleep(0.05)

    def open(self, url, width, height):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.ask("Page.navigate", url=url)

    def key(self, key, code=None, text=None, modifiers=0):
        keys = {"key": key, "code": code or key, "modifiers": modifiers}
        if text is not None:
            keys["text"] = text
        codes = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39,
                 "ArrowDown": 40, "Home": 36, "End": 35}
        keys["windowsVirtualKeyCode"] = codes.get(key, ord(key.upper()) if len(key) == 1 else 0)
        self.ask("Input.dispatchKeyEvent", type="keyDown", **keys)
        self.ask("Input.dispatchKeyEvent", type="keyUp", **keys)

    def mouse(self, kind, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, start, way):
        """Presses the mouse at a place, moves it to others, and lets go."""
        self.mouse("mousePressed", *start, button="left", buttons=1, clickCount=1)
        for place in way:
            self.mouse("mouseMoved", *place, button="left", buttons=1)
            time.sleep(0.03)
        self.mouse("mouseReleased", *way[-1], button="left", buttons=0, clickCount=1)

    def box(self, selector):
        """Returns the left, top, width and height of an element."""
        return self.value(f"(r => [r.left, r.top, r.width, r.height])("
                          f"document.querySelector({json.dumps(selector)}).getBoundingClientRect())")

    def picture(self, file):
        import base64
        file.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))

    def end(self):
        self.process.kill()
        self.process.wait()
        self.to.close()
        self.back.close()
