"""Certificates for tests, made by openssl: an authority, and the certificates that it signs."""

from __future__ import annotations

import shutil
import ssl
import subprocess
from pathlib import Path

from tests.support.needs import need

_COMMON_OPTIONS = ("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
    "ec_paramgen_curve:P-256",
           "-nodes", "-days", "2")  # fmt: skip


def der(file: Path) -> bytes:
    """Return the first certificate of a file."""
    end = "-----END CERTIFICATE-----"
    return ssl.PEM_cert_to_DER_cert(file.read_text(encoding="ascii").partition(end)[0] + end)


class Authority:
    """A certificate authority: `file` has its own certificate, `der` the same as bytes."""

    def __init__(self, folder: Path, name: str = "Aula") -> None:
        need("" if shutil.which("openssl") else "needs openssl")
        self._folder, self._key = folder, folder / f"{name}.key"
        self.file = folder / f"{name}.pem"
        _run(*_COMMON_OPTIONS, "-keyout", self._key, "-out", self.file, "-subj", f"/CN={name}")

    @property
    def der(self) -> bytes:
        return der(self.file)

    def rules(self, name: str, is_chain: bool = False) -> str:
        """Return Mosquitto's settings for TLS under a computer's name and 127.0.0.1.

        `is_chain`: it shows the authority's certificate after its own.
        """
        key, file = self._folder / f"{name}.key", self.sign(name)
        _run(*_COMMON_OPTIONS, "-CA", self.file, "-CAkey", self._key, "-keyout", key, "-out", file,
             "-subj", f"/CN={name}", "-addext", f"subjectAltName=DNS:{name},IP:127.0.0.1",
             "-addext", "basicConstraints=critical,CA:FALSE")  # fmt: skip
        if is_chain:
            acl_text = file.read_text(encoding="ascii")
            file.write_text(acl_text + self.file.read_text(encoding="ascii"), encoding="ascii")
        return f"certfile {file}\nkeyfile {key}"

    def sign(self, name: str) -> Path:
        """Return the file with the certificate signed for a name."""
        return self._folder / f"{name}.pem"


def _run(*command: str | Path) -> None:
    subprocess.run([str(word) for word in command], check=True, capture_output=True)
