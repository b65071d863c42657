from __future__ import annotations

import gc
import json
import threading
import urllib.error
import urllib.request
from urllib.parse import urlsplit

import pytest
from markupsafe import Markup

from drake_screw.errors import DrakeScrewError
from drake_screw.web.server import PanelServer, check_address, warning


@pytest.fixture
def server(meshcat):
    gc.collect()  # Meshcats that other tests left behind must not end in the server's thread
    server = PanelServer(meshcat.port(), Markup("<p>my panel</p>"), "a <title>")
    yield server
    server.close()


def get(server: PanelServer, path: str = "") -> bytes:
    with urllib.request.urlopen(server.url + path, timeout=10) as answer:
        return answer.read()


def post(server: PanelServer, content: bytes, kind: str = "application/json") -> int:
    request = urllib.request.Request(server.url + "do", content, {"Content-Type": kind})
    try:
        with urllib.request.urlopen(request, timeout=10) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_the_page_is_meshcats_with_a_panel(server, meshcat) -> None:
    page = get(server).decode()
    assert page.index("<p>my panel</p>") < page.rindex("</body>")
    assert "<title>a &lt;title&gt;</title>" in page
    assert f'there.port = "{meshcat.port()}"' in page
    assert "MeshCat.Viewer" in page


def test_what_is_not_its_own_comes_from_meshcat(server, meshcat) -> None:
    with urllib.request.urlopen(f"{meshcat.web_url()}/favicon.ico") as answer:
        assert get(server, "favicon.ico") == answer.read()
    with pytest.raises(urllib.error.HTTPError, match="404"):
        get(server, "nothing/here")


def test_a_new_state_wakes_whoever_waits(server) -> None:
    server.show({"n": 1})
    first = json.loads(get(server, "state?after=0"))
    assert first == {"version": 1, "state": {"n": 1}}
    heard: list[bytes] = []
    waiting = threading.Thread(target=lambda: heard.append(get(server, "state?after=1")))
    waiting.start()
    server.show({"n": 2})
    waiting.join(10)
    assert json.loads(heard[0]) == {"version": 2, "state": {"n": 2}}


def test_messages_arrive_in_order(server) -> None:
    assert server.message(0.0) is None
    for n in range(3):
        assert post(server, json.dumps({"n": n}).encode()) == 204
    assert [server.message(1.0) for _ in range(3)] == [{"n": 0}, {"n": 1}, {"n": 2}]


@pytest.mark.parametrize(
    ("content", "kind", "code"),
    [
        (b"{}", "text/plain", 415),
        (b"n=1", "application/x-www-form-urlencoded", 415),
        (b"{", "application/json", 400),
        (b"[1]", "application/json", 400),
        (b"[" * 9000, "application/json", 400),
        (b'{"a": ' + b"[" * 900 + b"1" + b"]" * 900 + b"}", "application/json", 400),
    ],
)
def test_other_messages_are_refused(server, content, kind, code) -> None:
    assert post(server, content, kind) == code
    assert server.message(0.0) is None


def test_a_taken_port_is_told(server, meshcat) -> None:
    port = int(server.url.rsplit(":", 1)[1].strip("/"))
    with pytest.raises(DrakeScrewError, match=f"port {port}"):
        PanelServer(meshcat.port(), Markup(), "", port=port)


def test_a_page_that_waits_gets_the_last_state(meshcat) -> None:
    server = PanelServer(meshcat.port(), Markup(), "")
    server.show({"n": 1})
    assert json.loads(get(server, "state?after=0"))["state"] == {"n": 1}
    answers: list[bytes] = []
    waiting = threading.Thread(target=lambda: answers.append(get(server, "state?after=1")))
    waiting.start()
    server.show({"n": 2})
    server.close()
    waiting.join(10)
    assert json.loads(answers[0])["state"] == {"n": 2}


def test_a_strange_question_gets_the_state(server) -> None:
    server.show({"n": 1})
    assert json.loads(get(server, "state?after=x"))["state"] == {"n": 1}


def test_addresses_are_checked_and_warned_of(server) -> None:
    port = urlsplit(server.url).port
    with pytest.raises(DrakeScrewError, match=f"cannot serve on localhost, port {port}"):
        check_address("localhost", port)
    with pytest.raises(DrakeScrewError, match=r"cannot serve on nowhere\.invalid:"):
        check_address("nowhere.invalid", None)
    check_address("localhost", None)
    assert warning("localhost") is None
    assert warning("127.0.0.1") is None
    assert "without a password" in (warning("0.0.0.0") or "")


@pytest.mark.parametrize("value", ["1e300", "NaN", "Infinity", "true", "[1, -1e10]", '{"a": 1}'])
def test_numbers_that_no_slider_has_are_refused(server, value) -> None:
    assert post(server, b'{"pose": 1, "value": ' + value.encode() + b"}") == 400
    assert server.message(0.0) is None
    assert post(server, b'{"at": [0.5, -1], "region": null, "do": "stop"}') == 204


def test_a_page_of_another_name_for_this_machine_is_refused(server) -> None:
    port = urlsplit(server.url).port
    headers = {"Content-Type": "application/json", "Host": f"elsewhere.example:{port}"}
    request = urllib.request.Request(server.url + "do", b'{"do": "accept"}', headers)
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(request, timeout=10)


def test_a_proxy_is_not_asked_for_meshcats_page(server, monkeypatch) -> None:
    monkeypatch.setenv("http_proxy", "http://localhost:9")
    monkeypatch.delenv("no_proxy", raising=False)
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(server.url, timeout=10) as answer:
        assert b"my panel" in answer.read()
