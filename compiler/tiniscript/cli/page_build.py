"""The studio's page in a clone: built if it is missing, if the person agrees.

It also asks whoever builds a wheel at a terminal of a clone.
"""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.cli import fetching
from tiniscript.cli.errors import CommandError
from tiniscript.cli.fetching import Part, Step
from tiniscript.cli.texts import language_of, say_aside, text
from tiniscript.library import install_advice
from tiniscript.studio import building, serving

NODE, NPM = Part("fetch_node", building.NODE_MB), Part("fetch_npm", building.NPM_MB)
STEP_KEYS = ("fetch_npm_now", "studio_types", "studio_packing", "studio_bundling")
STEP_START_PERCENT = (0, 0, 40, 95)  # share of the whole build at the start of each step


def prepare(options: Namespace, language: str) -> None:
    """Build a missing page, and print a note about a stale one. Raises CommandError."""
    if not serving.is_built():
        build(options, language)
    elif not building.is_built_from_sources(serving.PAGE):
        build_command = " ".join(map(install_advice.quote, (sys.executable, str(building.BUILDER))))
        say_aside("studio_stale", language, how=build_command)


def build(options: Namespace, language: str) -> None:
    """Build the page. Raises CommandError."""
    if not building.is_possible():
        raise CommandError(2, "studio_not_built")
    parts = missing_parts()
    has_node = NODE not in parts
    if not has_node and install_advice.install_command(install_advice.STUDIO) is None:
        install_command = install_advice.command(install_advice.STUDIO)
        raise CommandError(
            2, "studio_no_node", oldest=str(building.OLDEST_NODE), how=install_command
        )
    missing_text = text("studio_missing", language)
    fetching.ask_to_fetch(missing_text, parts, building.BUILD_MINUTES, options, language)
    if not has_node:
        fetching.install(install_advice.STUDIO, NODE, language)
    progress = fetching.FolderProgress(building.MODULES, building.NODE_MODULES_MB)

    def read_step(output: str) -> Step:
        step_number = max(building.step_number(output), 0 if NPM in parts else 1)
        is_fetching = STEP_KEYS[step_number] == "fetch_npm_now"
        return Step(
            STEP_KEYS[step_number],
            progress.percent() if is_fetching else STEP_START_PERCENT[step_number],
        )

    fetching.run([sys.executable, "-m", building.MODULE], building.CLONE, read_step, language)


def missing_parts() -> list[Part]:
    """Return the downloads needed before the page can be built."""
    node = [] if building.find_tools() is not None else [NODE]
    return node if building.are_packages_fetched() else [*node, NPM]


def megabytes() -> int:
    """Return the number of megabytes that `tsc studio` downloads before it opens the page."""
    return 0 if serving.is_built() else sum(part.mb for part in missing_parts())


def main() -> int:
    language = language_of([])
    try:
        build(Namespace(yes=False), language)
    except CommandError as error:
        print(error.sentence(language), file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
