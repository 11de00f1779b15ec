# SPDX-License-Identifier: Apache-2.0
"""Where notices go: a mail server, a server that takes POSTs, a listener at a broker. Each keeps what it got."""
import contextlib
import email
import email.policy
import http.server
import json
import logging
import socket
import ssl
import threading

import aiosmtpd.controller
import aiosmtpd.smtp
import mqtt_peer
from free_port import free_port


# What a test provokes is no news.
logging.getLogger("mail.log").setLevel(logging.CRITICAL)


class Mailbox:
    """aiosmtpd; `user` and `password` where it asks for them, then over TLS alone."""

    def __init__(self, port=None, certificates=None, user=None, password=None, refused=()):
        self.mails, self.logins, self.refused = [], [], set(refused)
        self.user, self.password = user, password
        more = {}
        if certificates:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(certificates / "broker.pem", certificates / "broker.key")
            more = {"tls_context": context, "require_starttls": True}
        if user:
            more |= {"authenticator": self._authenticate, "auth_required": True}
        self.port = port or free_port()
        self.controller = aiosmtpd.controller.Controller(self, "127.0.0.1", self.port, **more)
        self.controller.start()

    def _authenticate(self, server, session, envelope, mechanism, data):
        name, password = data.login.decode(), data.password.decode()
        self.logins.append((name, password))
        return aiosmtpd.smtp.AuthResult(success=(name, password) == (self.user, self.password), handled=False)

    async def handle_RCPT(self, server, session, envelope, address, options):
        if address in self.refused:
            return "550 there is no such person"
        envelope.rcpt_tos.append(address)
        return "250 OK"

    async def handle_DATA(self, server, session, envelope):
        mail = email.message_from_bytes(envelope.content, policy=email.policy.default)
        self.mails.append({"from": envelope.mail_from, "to": envelope.rcpt_tos, "raw": envelope.content, "subject": mail["Subject"],
                           "id": mail["Message-ID"], "headers": mail.keys(), "text": mail.get_content()})
        return "250 taken"

    def subjects(self):
        return [mail["subject"].split(": ", 1)[1] for mail in self.mails]

    def close(self):
        self.controller.stop()


class Webhook:
    """http.server; answers with `status`."""

    def __init__(self):
        self.notices, self.status = [], 200
        owner = self

        class Taker(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                owner.notices.append({"type": self.headers["Content-Type"], "path": self.path, **json.loads(body)})
                self.send_response(owner.status)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Taker)
        self.port = self.server.server_port
        self.thread = threading.Thread(target=self.server.serve_forever)
        self.thread.start()

    def kinds(self):
        return [notice["kind"] for notice in self.notices]

    def close(self):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


class Silent:
    """Takes connections and never says a word."""

    def __init__(self):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]

    def close(self):
        self.socket.close()


@contextlib.contextmanager
def listener(topic):
    """mosquitto, and a client that listens there: gives the broker and a function with the notices so far."""
    broker = mqtt_peer.Broker()
    broker.start()
    client = mqtt_peer.Client(broker.port, "listener")
    try:
        client.subscribe(topic)
        got = []

        def notices():
            got.extend(json.loads(payload) for _, payload, _ in client.poll(0.02))
            return got

        yield broker, notices
    finally:
        client.close()
        broker.close()
