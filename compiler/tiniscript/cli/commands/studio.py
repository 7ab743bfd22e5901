"""`tsc studio`: the studio's page, for a browser of this computer."""

from __future__ import annotations

import socket
import webbrowser
from argparse import Namespace
from contextlib import closing
from dataclasses import dataclass, field
from ipaddress import IPv4Address
from threading import Lock, Thread

from tiniscript.cli import inputs, page_build
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import whole_number
from tiniscript.cli.terminal.progress import show_wait
from tiniscript.cli.terminal.signals import handle_signals
from tiniscript.cli.texts import say_aside
from tiniscript.studio import building, class_keeping, serving
from tiniscript.studio.classroom import CHANGES, Classroom
from tiniscript.studio.hosting import Hosting
from tiniscript.studio.robot_link import Json

PORT = 7070
UNUSED_ADDRESS = "198.51.100.1"  # an address for documentation, which is never assigned


@dataclass
class _Class:
    room: Classroom
    keeper: class_keeping.Keeper
    _lock: Lock = field(default_factory=Lock)

    def teach(self, request: Json) -> Json:
        """Answer the teacher's page. What it has changed is kept before the page is told of it, so
        that no crash loses it.
        """
        answer = self.room.teach(request)
        if request.get("do") in CHANGES:
            self.keep()
        return answer

    def keep(self) -> None:
        with self._lock:  # an older state never replaces a newer one
            self.keeper.keep(self.room.state_to_keep())


def run(options: Namespace, language: str) -> int:
    port = whole_number("--listen", options.listen, PORT, 0, 65535, language)
    minutes = whole_number("--turn", options.turn, 0, 1, 60, language)
    hosting = Hosting()
    if not options.is_class:
        if options.address or options.ports or options.turn:
            raise CommandError(2, "studio_needs_class")
        return _serve(options, language, (serving.HOST, port), hosting)
    host = _address_option(options.address) if options.address else _address()
    room = Classroom(
        hosting, list(map(inputs.check_port, options.ports)), 60 * minutes or None,
        folder=class_keeping.groups_folder(),
    )  # fmt: skip
    with closing(_class_keeper()) as keeper:
        return _serve(options, language, (host, port), hosting, _Class(room, keeper))


def _serve(
    options: Namespace, language: str, host_and_port: tuple[str, int], hosting: Hosting,
    class_: _Class | None = None,
) -> int:  # fmt: skip
    resumed_count = _resume_class(class_) if class_ else 0
    if not serving.is_built() or building.is_possible():
        page_build.prepare(options, language)
    host, port = host_and_port
    try:
        server = _server(port, host, hosting, class_)
    except OSError as error:
        address = f"http://{host}:{port}/"
        key = "studio_no_address" if options.is_class else "studio_taken"
        raise CommandError(
            3, key, port=str(port), why=error, address=printable_name(address)
        ) from None
    thread = Thread(target=server.serve_forever, name="studio", daemon=True)
    try:
        with handle_signals():
            thread.start()
            entrance = server.entrance()
            print(entrance, flush=True)
            key = "studio_class" if class_ else "studio_here"
            values = {"address": server.address, "code": class_.room.code if class_ else ""}
            say_aside(key, language, **values)
            if resumed_count:
                say_aside("studio_goes_on", language, pupils=resumed_count)
            if not options.no_browser:
                webbrowser.open(server.entrance(is_for_this_computer=True))
            while thread.is_alive():
                thread.join(1)
                if not server.is_unused(entrance):
                    entrance = server.entrance()
                    say_aside("studio_opened", language)
                    print(entrance, flush=True)
                if class_ is not None:
                    class_.room.tend()
                    class_.keep()
                    if class_.room.has_ended:
                        break
    except KeyboardInterrupt:
        pass
    finally:
        if thread.is_alive():
            server.shutdown()  # shutting down a server that has not begun would wait forever
        with show_wait("studio_stops", language):
            unconfirmed_ports = hosting.close()
        for silent_port in unconfirmed_ports:
            say_aside("not_confirmed", language, port=printable_name(silent_port))
        server.server_close()
    return 0


def _class_keeper() -> class_keeping.Keeper:
    try:
        return class_keeping.Keeper()
    except class_keeping.ClassTaken:
        raise CommandError(3, "studio_two_classes") from None


def _resume_class(class_: _Class) -> int:
    """Go on with a class that a crash has ended; return how many pupils it has."""
    saved_class = class_.keeper.read()
    pupils = class_.room.resume(*saved_class) if saved_class is not None else 0
    class_.room.tidy()
    return pupils


def _server(port: int, host: str, hosting: Hosting, class_: _Class | None) -> serving.Server:
    page = serving.files()
    if class_ is None:
        return serving.Server(serving.with_firmware(page), port, hosting.answer)
    return serving.Server(serving.for_class(page), port, class_.teach, class_.room, host)


def _address() -> str:
    """Return this computer's address in the local network, without asking another computer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as connection:
        try:
            connection.connect((UNUSED_ADDRESS, 9))  # selects a path, and sends nothing
            return str(connection.getsockname()[0])
        except OSError:
            raise CommandError(3, "studio_no_network") from None


def _address_option(address: str) -> str:
    """Return the address of --address, which has no other form: Host must be exactly this."""
    try:
        ip_address = IPv4Address(address)
    except ValueError:
        ip_address = IPv4Address(0)
    if ip_address.is_unspecified or ip_address.is_multicast:
        raise CommandError(2, "studio_bad_address", found=printable_name(address))
    return str(ip_address)
