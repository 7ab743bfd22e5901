"""`tsc studio`: the studio's page, for a browser of this computer."""

from __future__ import annotations

import sys
import webbrowser
from argparse import Namespace
from threading import Thread

from tiniscript.cli.commands.robot import ended_by_signal
from tiniscript.cli.errors import CommandError
from tiniscript.cli.options import whole_number
from tiniscript.cli.texts.common import text
from tiniscript.studio import serving

PORT = 7070


def run(options: Namespace, language: str) -> int:
    port = whole_number("--listen", options.listen, PORT, 0, 65535, language)
    from tiniscript.studio.hosting import Hosting

    hosting = Hosting()
    try:
        server = serving.Server(serving.files(), port, hosting.answer)
    except serving.NotBuilt:
        raise CommandError(2, "studio_not_built") from None
    except OSError as why:
        address = f"http://{serving.HOST}:{port}/"
        reason = why.strerror or str(why)
        raise CommandError(3, "studio_taken", port=str(port), why=reason, address=address) from None
    thread = Thread(target=server.serve_forever, name="studio", daemon=True)
    try:
        with ended_by_signal():
            thread.start()
            print(server.entrance, flush=True)
            said = text("studio_here", language).format(address=server.entrance)
            print(said, file=sys.stderr, flush=True)
            if not options.no_browser:
                webbrowser.open(server.entrance)
            while thread.is_alive():
                thread.join(1)
    except KeyboardInterrupt:
        pass
    finally:
        server.shutdown()
        hosting.close()
        server.server_close()
    return 0
