"""Requests of a session that have not been sent."""

from __future__ import annotations

from tests.machines.host_firmware import HostFirmware
from tests.support.session_resets import KIT
from tiniscript import compile_text
from tiniscript.bytecode.image import Image, unpack
from tiniscript.link.connection import PendingRequest
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


def image(text: str) -> Image:
    return unpack(compile_text(text, KIT).image)


def live(session: Session) -> PendingRequest[ReceiptReply]:
    return session.live(image("SHOW(2)").code)


def upload(session: Session) -> PendingRequest[ReceiptReply]:
    return session.upload(image("SHOW(2)"))


def long_upload(session: Session) -> PendingRequest[ReceiptReply]:
    return session.upload(image("SHOW(2);" * 30))


def open_session() -> tuple[Session, HostFirmware]:
    session, robot = Session(1, 9600, KIT.fingerprint), HostFirmware(KIT)
    robot.wait(100)
    assert robot.until(session, session.hello()) == OK
    robot.talk(session, 300)
    return session, robot
