"""The error that ends a command: a sentence in the user's language, and an exit code."""

from __future__ import annotations

from tiniscript.base import languages
from tiniscript.cli.texts import Sentence, text


class CommandError(Exception):
    """`key` names a sentence of `texts`; `values` fill its gaps.

    A value `near` that is not empty adds a suggestion; an exception is shown with the system's
    message.
    """

    def __init__(self, exit_code: int, key: str, **values: str | Exception) -> None:
        super().__init__(key)
        self.exit_code = exit_code
        self.key = key
        self.values = {name: _value_text(value) for name, value in values.items()}

    def sentence(self, language: str) -> str:
        sentence_text = text(self.key, language).format(**self.values)
        if self.values.get("near"):
            suggestion = text("did_you_mean", language).format(near=self.values["near"])
            try_label = f" {languages.text('messages', 'label/try', language)}  "
            failure, advice, example = sentence_text.rpartition(
                try_label
            )  # the command line may contain it
            return Sentence(
                f"{failure} {suggestion}{advice}{example}"
                if advice
                else f"{sentence_text} {suggestion}"
            )
        return sentence_text

    def plain_sentence(self, language: str) -> str:
        """Return the sentence without the name of the command, for a table or a list."""
        return self.sentence(language).removeprefix("tsc: ")


def _value_text(value: str | Exception) -> str:
    return (value.strerror if isinstance(value, OSError) else None) or str(value)


def unwritable_error(key_and_option: str, file: str, cause: str | Exception) -> CommandError:
    """Return the error for a file that cannot be written; the key may be followed by an option."""
    key, _, option = key_and_option.partition(" ")
    return CommandError(2, key, file=file, why=cause, option=option)


def missing_package_error(key: str, error: Exception) -> CommandError:
    """Return the error for missing packages of a virtual robot."""
    from tiniscript.library import install_advice

    return CommandError(2, key, why=error, how=install_advice.command(install_advice.VIRTUAL))
