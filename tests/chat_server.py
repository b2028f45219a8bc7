"""A real HTTP server that speaks chat-completions, answers as told, and fails in every way."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from toponav.reasoning.vlm.chat import FailureKind


class Fault(StrEnum):
    """What can go wrong with one request."""

    DROPPED = "connection dropped"
    HANGING = "hanging"
    UNAUTHORIZED = "401"
    RATE_LIMITED = "429"
    SERVER_ERROR = "500"
    TRUNCATED = "truncated JSON"
    WRONG_TYPES = "wrong types"
    UNKNOWN_NODE = "unknown node"
    DIRECTION_99 = "direction 99"
    NO_CHOICES = "empty choices"
    FILTERED = "content filter"
    HUGE = "10 MB answer"
    NOT_UTF8 = "invalid UTF-8"
    NO_ANSWER = "no JSON at all"


SEEN_AS = {
    Fault.DROPPED: FailureKind.NO_CONNECTION,
    Fault.HANGING: FailureKind.TIMEOUT,
    Fault.UNAUTHORIZED: FailureKind.UNAUTHORIZED,
    Fault.RATE_LIMITED: FailureKind.RATE_LIMITED,
    Fault.SERVER_ERROR: FailureKind.SERVER_ERROR,
    Fault.TRUNCATED: FailureKind.UNUSABLE,
    Fault.WRONG_TYPES: FailureKind.UNUSABLE,
    Fault.UNKNOWN_NODE: FailureKind.UNUSABLE,
    Fault.DIRECTION_99: FailureKind.UNUSABLE,
    Fault.NO_CHOICES: FailureKind.MALFORMED,
    Fault.FILTERED: FailureKind.FILTERED,
    Fault.HUGE: FailureKind.TOO_LONG,
    Fault.NOT_UTF8: FailureKind.MALFORMED,
    Fault.NO_ANSWER: FailureKind.UNUSABLE,
}
"""What the ledger calls each fault."""

HANG_S = 1.5
RETRY_AFTER_S = "0.01"

Script = Callable[[dict[str, Any]], "str | Fault | tuple[int, str]"]
"""From a request's body to what the model says, a fault, or a status and a complaint."""


class ChatServer:
    """The server, while its context is open."""

    def __init__(self, script: Script) -> None:
        self.script = script
        self.requests: list[dict[str, Any]] = []
        self.keys: list[str] = []
        self.faults: Counter[str] = Counter()
        self.url = ""
        self._lock = threading.Lock()

    def answer(self, body: dict[str, Any], key: str) -> str | Fault | tuple[int, str]:
        """What becomes of a request; one at a time, so that scripts need no locks."""
        with self._lock:
            self.requests.append(body)
            self.keys.append(key)
            said = self.script(body)
            if isinstance(said, Fault):
                self.faults[SEEN_AS[said]] += 1
            return said


@contextmanager
def chat_server(script: Script) -> Iterator[ChatServer]:
    """A server on a free port."""
    state = ChatServer(script)

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            said = state.answer(body, self.headers.get("Authorization", ""))
            if isinstance(said, tuple):
                self.refuse(*said)
            elif isinstance(said, Fault):
                self.fail(said)
            else:
                self.send(200, completion(said))

        def fail(self, fault: Fault) -> None:
            statuses = {Fault.UNAUTHORIZED: 401, Fault.RATE_LIMITED: 429, Fault.SERVER_ERROR: 500}
            if fault in statuses:
                key = self.headers.get("Authorization", "").removeprefix("Bearer ")
                self.refuse(statuses[fault], f"no, says the server to {key}")
            elif fault is Fault.DROPPED:
                self.close_connection = True
                self.connection.close()
            elif fault is Fault.HANGING:
                time.sleep(HANG_S)
                self.close_connection = True
            elif fault is Fault.NO_CHOICES:
                self.send(200, {"choices": []})
            elif fault is Fault.FILTERED:
                self.send(200, completion("", finish_reason="content_filter"))
            elif fault is Fault.HUGE:
                self.send(200, completion("x" * 10_000_000))
            elif fault is Fault.NOT_UTF8:
                self.send_bytes(200, b'{"choices": [{"message": {"content": "\xff\xfe"}}]}')
            else:
                self.send(200, completion(WRONG_ANSWERS[fault]))

        def refuse(self, status: int, complaint: str) -> None:
            self.send(status, {"error": {"message": complaint, "code": None}})

        def send(self, status: int, data: dict[str, Any]) -> None:
            self.send_bytes(status, json.dumps(data).encode())

        def send_bytes(self, status: int, data: bytes) -> None:
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            if status == 429:
                self.send_header("Retry-After", RETRY_AFTER_S)
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *args: Any) -> None:
            """Silent."""

    class Server(ThreadingHTTPServer):
        daemon_threads = True

        def handle_error(self, request: Any, client_address: Any) -> None:
            """A client that hangs up on a fault is no error."""

    server = Server(("127.0.0.1", 0), Handler)
    state.url = f"http://127.0.0.1:{server.server_address[1]}/v1"
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield state
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


GOOD = {
    "reason": "why not",
    "room_type": "Living Room",
    "target_found": False,
    "direction": 1,
    "node_id": 1,
}
"""An answer that the smallest memory allows."""

WRONG_ANSWERS = {
    Fault.TRUNCATED: json.dumps(GOOD)[:40],
    Fault.WRONG_TYPES: json.dumps({**GOOD, "direction": "left", "target_found": [1]}),
    Fault.UNKNOWN_NODE: json.dumps({**GOOD, "node_id": 4711}),
    Fault.DIRECTION_99: json.dumps({**GOOD, "direction": 99}),
    Fault.NO_ANSWER: "I would rather not say.",
}


def completion(text: str, finish_reason: str = "stop") -> dict[str, Any]:
    """The body of a reply."""
    return {
        "id": "x",
        "object": "chat.completion",
        "created": 0,
        "model": "test",
        "choices": [
            {
                "index": 0,
                "message": {"role": "assistant", "content": text},
                "finish_reason": finish_reason,
            }
        ],
        "usage": {"prompt_tokens": 1000, "completion_tokens": 50, "total_tokens": 1050},
    }


def prompt_text(body: dict[str, Any]) -> str:
    """The question of a request, without its images."""
    content = body["messages"][1]["content"]
    if isinstance(content, str):
        return content
    return "\n\n".join(part["text"] for part in content if part["type"] == "text")
