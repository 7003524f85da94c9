"""What a hostile page, program or file may try on the studio: refused cleanly, and the server
lives.
"""

from __future__ import annotations

import json
import shutil
import socket
from contextlib import suppress
from pathlib import Path
from urllib.parse import unquote

import pytest

from tandem.files.load import load
from tests.studio.running import Running, until

THESIS = Path("examples/thesis.yaml")
MARK = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with cells, beside it a secret one, and links that lead there."""
    around = tmp_path_factory.mktemp("around")
    inside = around / "inside"
    (inside / ".hidden").mkdir(parents=True)
    (around / "outside").mkdir()
    for place in ("inside/cell.yaml", "inside/.hidden/cell.yaml", "outside/secret.yaml"):
        shutil.copy(THESIS, around / place)
    (inside / "link.yaml").symlink_to(around / "outside" / "secret.yaml")
    (inside / "linked").symlink_to(around / "outside")
    (inside / "notes.txt").write_text("not a cell")
    return inside


@pytest.fixture(scope="module")
def server(folder):
    with Running(folder) as running:
        yield running
        # whatever was tried: the server lives, and ends as it should
        assert running.ask("GET", "/api/health").status == 200
        code, out, err = running.end()
        assert (code, out) == (0, "")
        assert "Traceback" not in err


def raw(server: Running, request: bytes) -> bytes:
    """Bytes to the socket, and all that comes back."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as connection:
        connection.sendall(request)
        return b"".join(iter(lambda: connection.recv(65536), b""))


# --- who asks -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil:80", ""]
)
@pytest.mark.parametrize("path", ["/", "/api/cell", "/api/health", "/static/x.js"])
def test_a_foreign_host_gets_nothing(server, host, path):
    answer = server.ask("GET", path, headers={"Host": host})
    assert answer.status == 403
    assert "tasks" not in answer.body.decode()


def test_no_host_and_two_hosts_get_nothing(server):
    own = f"Host: {server.host}\r\n".encode()
    for hosts in (b"", own + b"Host: evil.example\r\n"):
        answer = raw(server, b"GET /api/cell HTTP/1.1\r\n" + hosts + b"Connection: close\r\n\r\n")
        assert answer.split(b" ")[1][:1] == b"4"
        assert b"tasks" not in answer


def test_localhost_is_this_server_too(server):
    assert (
        server.ask("GET", "/api/health", headers={"Host": f"localhost:{server.port}"}).status == 200
    )


WRITES = [
    ("PUT", "/api/cell"),
    *(
        ("POST", f"/api/{what}")
        for what in (
            *("check", "draft", "plan", "plan/stop", "place"),
            *("replan", "explain", "report", "import"),
        )
    ),
]


@pytest.mark.parametrize(("method", "path"), WRITES)
def test_every_write_needs_the_token_of_this_start(server, folder, method, path):
    before = (folder / "cell.yaml").read_bytes()
    for token in (None, "wrong", server.token[:-1], server.token + "x", "ä"):
        assert server.ask(method, path, {}, token=token).status == 403
    # in the address it counts for the stream alone
    assert server.ask(method, f"{path}?token={server.token}", {}, token=None).status == 403
    assert (folder / "cell.yaml").read_bytes() == before


def test_a_stream_computes_and_so_needs_the_token(server):
    for query in ("", "?token=", "?token=wrong", f"?token={server.token}&token=x"):
        assert server.ask("GET", f"/api/plan/stream{query}", token=None).status == 403


@pytest.mark.parametrize(
    "origin", ["https://evil.example", "null", "http://127.0.0.1:1", "file://"]
)
def test_a_page_of_another_origin_is_refused_though_it_had_the_token(server, origin):
    for method, path in (("GET", "/api/cell"), ("POST", "/api/check"), ("OPTIONS", "/api/cell")):
        answer = server.ask(method, path, {"cell": {}}, headers={"Origin": origin})
        assert answer.status == 403
        assert not any(name.startswith("access-control") for name in answer.headers)


def test_a_page_of_this_origin_is_let_in(server):
    headers = {"Origin": server.address, "Sec-Fetch-Site": "same-origin"}
    assert server.ask("POST", "/api/check", {"cell": {}}, headers=headers).status == 200


def test_what_browsers_say_of_foreign_pages_is_heard(server):
    for site in ("cross-site", "same-site"):
        assert server.ask("GET", "/api/cell", headers={"Sec-Fetch-Site": site}).status == 403


def test_each_answer_tells_the_browser_to_do_nothing_else_with_it(server):
    for path in ("/", "/api/cell", "/api/none", "/static/none"):
        headers = server.ask("GET", path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["x-frame-options"] == "DENY"
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert headers["referrer-policy"] == "no-referrer"
        assert "server" not in headers


# --- which files ----------------------------------------------------------------------------------


OUTSIDE = [
    "../outside/secret.yaml",
    "..%2Foutside%2Fsecret.yaml",
    "%2e%2e/outside/secret.yaml",
    "linked/../../outside/secret.yaml",
    "/etc/passwd",
    "//etc/passwd.yaml",
    "link.yaml",
    "linked/secret.yaml",
    ".hidden/cell.yaml",
    "..\\outside\\secret.yaml",
    "C:/secret.yaml",
    "cell.yaml%00.yaml",
    "notes.txt",
    "./cell.yaml",
    "",
]


@pytest.mark.parametrize("name", OUTSIDE)
def test_only_files_of_the_folder_are_read_or_written(server, folder, name):
    secret = folder.parent / "outside" / "secret.yaml"
    before = secret.read_bytes()
    answer = server.ask("GET", f"/api/cell?file={name}")
    assert answer.status == 403
    assert "tasks" not in answer.json
    cell = load(THESIS).to_dict()
    assert server.ask("PUT", f"/api/cell?file={name}", {"cell": cell}).status == 403
    assert server.ask("POST", "/api/plan", {"file": unquote(name)}).status == 403
    assert secret.read_bytes() == before
    assert sorted(path.name for path in secret.parent.iterdir()) == ["secret.yaml"]


def test_links_are_not_listed(server):
    listed = server.ask("GET", "/api/files").json["files"]
    assert [file["name"] for file in listed] == ["cell.yaml"]


def test_a_link_in_place_of_a_draft_is_not_followed(tmp_path):
    (tmp_path / "cells").mkdir()
    file = Path(shutil.copy(THESIS, tmp_path / "cells" / "cell.yaml"))
    victim = tmp_path / "victim.json"
    victim.write_text("mine")
    (tmp_path / "cells" / "cell.yaml.draft.json").symlink_to(victim)
    with Running(file) as running:
        running.ask("POST", "/api/draft", {"cell": {"tasks": {}}})
        assert running.end()[0] == 0
    assert victim.read_text() == "mine"


@pytest.mark.parametrize(
    "path",
    [
        "/static/../worker.py",
        "/static/%2e%2e/worker.py",
        "/static/..%2fworker.py",
        "/static//etc/passwd",
        "/static/%00",
        "/static/VERSION/../worker.py",
        "/static/VERSION/%2e%2e/worker.py",
        "/static/VERSION/..%2f..%2fworker.py",
        "/static/VERSION//etc/passwd",
        "/../../etc/passwd",
    ],
)
def test_of_the_package_only_the_page_is_sent(server, path):
    version = server.ask("GET", "/").body.decode().partition("/static/")[2].partition("/")[0]
    path = path.replace("VERSION", version)
    request = f"GET {path} HTTP/1.1\r\nHost: {server.host}\r\nConnection: close\r\n\r\n"
    answer = raw(server, request.encode())
    assert answer.split(b" ")[1] in (b"400", b"404")
    assert b"import" not in answer
    assert b"root:" not in answer


def test_only_the_one_file_is_open_when_one_was_given(tmp_path):
    for name in ("a.yaml", "b.yaml"):
        shutil.copy(THESIS, tmp_path / name)
    with Running(tmp_path / "a.yaml") as running:
        assert running.ask("GET", "/api/cell?file=b.yaml").status == 403
        cell = load(THESIS).to_dict()
        assert running.ask("PUT", "/api/cell?file=c.yaml", {"cell": cell}).status == 403
    assert not (tmp_path / "c.yaml").exists()


# --- what is sent ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "path"), [("PUT", "/api/cell"), ("POST", "/api/import"), ("POST", "/api/plan")]
)
def test_a_body_of_100_mb_is_refused_with_413(server, method, path):
    answer = server.ask(method, path, b"x" * 100_000_000)
    assert answer.status == 413
    assert "8 MB" in answer.json["error"]


def test_a_body_of_100_mb_without_the_token_is_refused_as_well(server):
    assert server.ask("POST", "/api/plan", b"x" * 100_000_000, token=None).status == 403


def test_a_large_body_that_does_not_say_how_large_is_refused(server):
    chunk = b"%x\r\n" % 1_000_000 + b"x" * 1_000_000 + b"\r\n"
    head = (
        f"POST /api/check HTTP/1.1\r\nHost: {server.host}\r\nX-Tandem-Token: {server.token}\r\n"
        "Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n"
    )
    answer = raw(server, head.encode() + chunk * 12 + b"0\r\n\r\n")
    assert answer.split(b" ")[1] == b"413"


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[1, 2",
        b"nonsense",
        b"\xff\xfe\x00",
        b'{"cell": NaN}',
        b"[" * 100_000,
        b'{"cell": ' + b'{"a":' * 50_000 + b"1" + b"}" * 50_001,
        b"[]",
        b"null",
        b'"text"',
        b'{"cell": 3}',
        b'{"unknown": 1}',
    ],
    ids=range(12),
)
def test_what_is_no_request_is_refused_with_a_sentence(server, body):
    for path in ("/api/check", "/api/plan", "/api/draft", "/api/place"):
        answer = server.ask("POST", path, body)
        assert answer.status in (400, 422)
        assert answer.json["error"]
        assert "Traceback" not in answer.body.decode()


def test_a_deeply_nested_cell_is_refused(server):
    cell: dict = {}
    for _ in range(400):
        cell = {"tasks": cell}
    answer = server.ask("POST", "/api/check", {"cell": cell})
    assert answer.status in (200, 400, 422)
    assert answer.status != 200 or answer.json["errors"]


def test_what_is_no_workbook_is_refused(server):
    for name, data in (("x.xlsx", b"PK\x03\x04garbage"), ("x.ods", b"\0" * 999), ("x.exe", b"MZ")):
        answer = server.ask("POST", f"/api/import?name={name}", data)
        assert answer.status in (400, 422)
        assert "/tmp" not in answer.body.decode()


def test_a_method_by_its_dotted_name_is_not_imported(server, tmp_path):
    for method in ("os:system", "antigravity:fly", "tests.studio.running:until"):
        answer = server.ask("POST", "/api/plan", {"options": {"method": method}})
        assert answer.status == 400
        assert "there is no method" in answer.json["error"]


def test_a_module_in_the_users_folder_is_not_run(tmp_path, monkeypatch):
    shutil.copy(THESIS, tmp_path / "cell.yaml")
    trap = "import pathlib; pathlib.Path('sprung').touch()\n"
    for name in ("ortools.py", "tandem.py", "numba.py"):
        (tmp_path / name).write_text(trap)
    monkeypatch.setenv("PYTHONPATH", str(Path("src").absolute()))
    monkeypatch.chdir(tmp_path)
    with Running("cell.yaml", "-P") as running:  # as the installed command begins
        assert running.ask("POST", "/api/plan", {"options": {"time_limit": 60}}).status == 200
    assert not (tmp_path / "sprung").exists()


def test_script_in_names_stays_text(tmp_path):
    cell = {
        "name": MARK,
        "operators": {"human": {"kind": "human", "label": MARK}, "robot": {"kind": "robot"}},
        "tasks": {MARK: {"time": {"human": 3, "robot": 4}, "stress": 1, "label": MARK}},
    }
    file = tmp_path / "cell.json"
    file.write_text(json.dumps(cell))
    with Running(file) as running:
        told = running.ask("GET", "/api/cell")
        assert told.headers["content-type"] == "application/json"
        assert MARK in told.json["cell"]["tasks"]
        plan = running.ask("POST", "/api/plan", {"options": {"time_limit": 60}}).json
        for form in ("html", "svg", "md"):
            report = running.ask("POST", "/api/report", {"plan": plan, "form": form})
            assert report.status == 200
            assert report.headers["content-disposition"].startswith("attachment")
            if form != "md":
                assert b"<script>alert" not in report.body


# --- how much -------------------------------------------------------------------------------------


def test_200_streams_at_once_leave_the_server_alive(server):
    streams = []
    for _ in range(200):
        connection = socket.create_connection(("127.0.0.1", server.port), timeout=60)
        request = (
            f"GET /api/plan/stream?token={server.token}&time_limit=60 HTTP/1.1\r\n"
            f"Host: {server.host}\r\n\r\n"
        )
        connection.sendall(request.encode())
        streams.append(connection)
    statuses = [connection.recv(12).split(b" ")[1] for connection in streams]
    assert set(statuses) <= {b"200", b"503"}
    assert b"200" in statuses
    assert server.ask("GET", "/api/health").status == 200
    for connection in streams:
        connection.close()

    def planned():
        answer = server.ask("POST", "/api/plan", {"options": {"time_limit": 60}})
        return answer.status == 200 and answer.json["complete"]

    until(planned, "a place is free again")


def test_what_is_no_http_ends_the_connection_alone(server):
    for nonsense in (b"\0" * 1000, b"GET / HTTP/9.9\r\n\r\n", b"X" * 200_000, b"\r\n\r\n"):
        connection = socket.create_connection(("127.0.0.1", server.port), timeout=60)
        with connection, suppress(ConnectionError):
            connection.sendall(nonsense)
            with suppress(OSError):  # ended by the server between the two
                connection.shutdown(socket.SHUT_WR)
            connection.recv(100)
    assert server.ask("GET", "/api/health").status == 200
