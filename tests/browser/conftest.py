"""A headless Chromium, and what the tests ask it about Meshcat's scene."""

from __future__ import annotations

import gc
import io
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

from tests.small_runs import finished_run

__all__ = ["browser", "finished_run", "tidy"]

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--hide-scrollbars",
    "--window-size=1300,900",
)
PATIENCE = 60.0


class Browser:
    """Selenium's driver with the few questions that the tests have."""

    def __init__(self, driver: Any) -> None:
        self.driver = driver

    def open(self, url: str) -> None:
        self.driver.get("about:blank")
        self.complaints()
        self.driver.get(url)
        self.until(lambda: self.ask("return document.readyState === 'complete'"))

    def ask(self, script: str, *arguments: Any) -> Any:
        return self.driver.execute_script(script, *arguments)

    def text(self, selector: str) -> str:
        return self.ask("return document.querySelector(arguments[0])?.textContent ?? ''", selector)

    def click(self, selector: str) -> None:
        """Click an element, found again where a new state of the panel has just replaced it."""
        from selenium.common.exceptions import StaleElementReferenceException

        def clicked() -> bool:
            try:
                self.driver.find_element("css selector", selector).click()
            except StaleElementReferenceException:
                return False
            return True

        self.until(clicked)

    def until(self, condition: Callable[[], Any]) -> Any:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            found = condition()
            if found:
                return found
            time.sleep(0.05)
        raise AssertionError(f"not within {PATIENCE} s; the panel says: {self.text('#panel')}")

    def still(self, reading: Callable[[], Any]) -> Any:
        """A reading, once it no longer changes."""

        def twice() -> list[Any]:
            first = reading()
            time.sleep(0.4)
            return [first] if reading() == first else []

        return self.until(twice)[0]

    def slide(self, selector: str, value: float) -> None:
        """Move a slider as a hand would, with the event that goes with it."""
        self.ask(
            "const s = document.querySelector(arguments[0]); s.value = arguments[1];"
            "s.dispatchEvent(new Event('input'))",
            selector,
            value,
        )

    def pull(self, selector: str, by: tuple[int, int], *, touch: bool = False) -> None:
        """Drag the middle of an SVG path by so many pixels, with the mouse or a finger."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder
        from selenium.webdriver.common.actions.pointer_input import PointerInput

        x, y = self.ask(
            """
            const path = document.querySelector(arguments[0]);
            const box = path.ownerSVGElement.getBoundingClientRect();
            const p = path.getPointAtLength(0.5 * path.getTotalLength());
            return [box.left + p.x, box.top + p.y];
            """,
            selector,
        )
        pointer = PointerInput("touch" if touch else "mouse", "finger" if touch else "mouse")
        actions = ActionBuilder(self.driver, mouse=pointer, duration=20)
        hand = actions.pointer_action
        hand.move_to_location(round(x), round(y)).pointer_down()
        for k in range(1, 6):
            hand.move_to_location(round(x + by[0] * k / 5), round(y + by[1] * k / 5))
        hand.pointer_up()
        actions.perform()

    def fits(self) -> bool:
        """Whether nothing of the page is wider than its window, nor of a panel than the panel."""
        return self.ask(
            """
            const wide = (item) => item.scrollWidth > item.clientWidth;
            const panels = [...document.querySelectorAll("#panel, #playback")];
            return ![document.documentElement, ...panels].some(wide);
            """
        )

    def select(self, selector: str, value: object) -> None:
        """Choose an entry of a list."""
        self.ask(
            "const s = document.querySelector(arguments[0]); s.value = arguments[1];"
            "s.dispatchEvent(new Event('change'))",
            selector,
            str(value),
        )

    def node(self, path: str) -> dict[str, Any] | None:
        """A node of the scene tree: whether it is seen, and its X_WN; None if there is none."""
        found = self.ask(
            """
            let node = viewer.scene_tree;
            for (const part of arguments[0].split("/")) {
              node = node.children[part];
              if (!node) return null;
            }
            let seen = true;
            for (let o = node.object; o; o = o.parent) seen = seen && o.visible;
            node.object.updateWorldMatrix(true, true);
            return {seen, children: Object.keys(node.children),
                    matrix: node.object.matrixWorld.elements};
            """,
            path,
        )
        if found is not None:
            found["matrix"] = np.array(found["matrix"]).reshape(4, 4).T
        return found

    def pixel(self, p_W: Any) -> tuple[int, int]:
        """Where a point (3,) m is on the screen."""
        return tuple(
            self.ask(
                """
                const [x, y, z] = arguments[0];
                viewer.camera.updateMatrixWorld();
                const p = new MeshCat.THREE.Vector3(x, z, -y).project(viewer.camera);
                const box = viewer.renderer.domElement.getBoundingClientRect();
                return [Math.round(box.left + (p.x + 1) / 2 * box.width),
                        Math.round(box.top + (1 - p.y) / 2 * box.height)];
                """,
                list(map(float, p_W)),
            )
        )

    @contextmanager
    def screen_of(self, width: int, height: int) -> Iterator[None]:
        """A screen of another size, in pixels."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        try:
            self.until(lambda: self.ask("return [innerWidth, innerHeight]") == [width, height])
            yield
        finally:
            self.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def screen(self) -> np.ndarray:
        """(height, width, 3) sRGB in [0, 1]."""
        return imread(io.BytesIO(self.driver.get_screenshot_as_png()))[..., :3]

    def complaints(self) -> list[str]:
        """Errors on the page's console."""
        return [e["message"] for e in self.driver.get_log("browser") if e["level"] == "SEVERE"]


@pytest.fixture(autouse=True)
def tidy() -> None:
    """Meshcats that other tests left behind must not end in a page's thread."""
    gc.collect()


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """It ends with these tests: a page that is left open goes on drawing."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    chromium, service = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or service is None:
        pytest.skip("chromium or chromedriver (Debian's chromium-driver) is not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in FLAGS:
        options.add_argument(flag)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(service))
    yield Browser(driver)
    driver.quit()


@contextmanager
def program(script: str, *arguments: object) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A Python program that prints the URL it serves; it gets Ctrl-C at the end."""
    command = [sys.executable, "-c", script, *map(str, arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, env=environment, **pipes) as process:
        assert process.stdout is not None
        heard = ""
        try:
            for line in process.stdout:
                heard += line
                found = re.search(r"open (http://\S+)", line)
                if found:
                    yield found[1], process
                    break
            else:
                raise AssertionError(f"it served nothing: {heard}")
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
