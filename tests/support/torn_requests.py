"""Requests of the page to `tsc studio` that are torn on the way."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route


def tear_requests(
    page: Page, verb: str, tear: Callable[[Route], None], times: int = 1
) -> list[str]:
    """Tear the first `times` requests of a verb; return the list of those."""
    torn_requests: list[str] = []

    def handle(route: Route) -> None:
        data = route.request.post_data or ""
        if f'"do":"{verb}"' not in data or len(torn_requests) >= times:
            route.continue_()
            return
        torn_requests.append(data)
        tear(route)

    page.route("**/robots", handle)
    return torn_requests


def lose_answer(route: Route) -> None:
    route.fetch()
    route.abort()


def refuse(route: Route) -> None:
    route.fulfill(status=500, body="<html>Internal Server Error</html>")
