"""The USB stick for a room without internet: `tools/builds/usb_stick.py`.

The packages of the test are the installed ones, repacked as wheels, so no download is needed.
"""

from __future__ import annotations

import base64
import hashlib
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from importlib.metadata import Distribution, distribution
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote

import pytest

from tests.support import studio
from tests.support.casefile import ROOT
from tests.support.needs import need as need_package
from tools.builds import stick_wheels, usb_stick
from tools.builds.stick_wheels import PYTHONS, SYSTEMS

OFFLINE_COMMAND = ["unshare", "--map-root-user", "--net"]  # a process without a network


@pytest.fixture(scope="module")
def stick(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stick") / "memoria niñ@s & más"
    folder.mkdir()
    usb_stick.add_texts(folder)
    usb_stick.add_readme(
        folder, "Linux", "3.11", [usb_stick.MissingPart("no_radio", "BeOS", "no network")]
    )
    return folder


def make_wheel(distribution: Distribution, folder: Path) -> None:
    """Make a wheel of an installed distribution."""
    name = re.sub(r"[-.]+", "_", distribution.metadata["Name"])
    tag = re.findall(r"(?m)^Tag: (\S+)$", distribution.read_text("WHEEL") or "")[-1]
    rows = []
    with zipfile.ZipFile(folder / f"{name}-{distribution.version}-{tag}.whl", "w") as wheel:
        for file in distribution.files or ():
            member_name = file.as_posix()
            if ".." in member_name or member_name.endswith(
                (".pyc", "RECORD", "INSTALLER", "REQUESTED")
            ):
                continue
            data = Path(str(file.locate())).read_bytes()
            wheel.writestr(member_name, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append(f"{member_name},sha256={digest},{len(data)}\n")
            if member_name.endswith(".dist-info/METADATA"):
                record = member_name.replace("METADATA", "RECORD")
        wheel.writestr(record, "".join([*rows, f"{record},,\n"]))


def list_installed(root: str, extras: set[str]) -> dict[str, Distribution]:
    """Return a distribution's requirements, and theirs, that this computer has."""
    from packaging.requirements import Requirement

    distributions: dict[str, Distribution] = {}
    waiting = [(root, extras)]
    while waiting:
        name, expected_names = waiting.pop()
        package = distribution(name)
        for text in package.requires or ():
            need = Requirement(text)
            environments = [{"extra": extra} for extra in expected_names] or [{"extra": ""}]
            if need.marker and not any(
                need.marker.evaluate(environment) for environment in environments
            ):
                continue
            if need.name not in distributions:
                distributions[need.name] = distribution(need.name)
                waiting.append((need.name, set(need.extras)))
    return distributions


@pytest.mark.sampled(of="sticks that pip reads")
def test_the_stick_installs_offline(stick: Path, tmp_path: Path) -> None:
    for needed_module in ("wasmtime", "bleak", "zeroconf", "PIL", "setuptools"):
        # An import of setuptools would replace the distutils of this process.
        need_package("" if find_spec(needed_module) else f"no package {needed_module}")
    wheels = stick / "wheels"
    wheels.mkdir()
    for installed_one in list_installed("tiniscript", {"radio", "virtual"}).values():
        make_wheel(installed_one, wheels)
    copy = tmp_path / "copy"  # a build leaves folders
    copy.mkdir()
    for name in ("compiler", "vm_arduino", "pyproject.toml", "setup.py", "README.md", "LICENSE"):
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, copy / name)
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-index", "--no-deps",
             "--no-build-isolation", "--wheel-dir", str(wheels), str(copy)]  # fmt: skip
    subprocess.run(build, check=True)

    home = tmp_path / "Ana María"
    tsc = home / "tsc" / "bin" / "tsc"
    is_cut_off = not subprocess.run([*OFFLINE_COMMAND, "true"], capture_output=True).returncode
    command = [*(OFFLINE_COMMAND if is_cut_off else []), "sh", str(stick / "start.sh"), str(home)]
    variables = {"PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin", "LC_ALL": "es_PE.UTF-8",
                 "HOME": str(tmp_path)}  # fmt: skip
    for _ in range(2):
        completed = subprocess.run(command, env=variables, capture_output=True, text=True)
        assert completed.returncode == 0, completed.stdout + completed.stderr
        assert "Listo." in completed.stdout
        assert "no funciona" not in completed.stdout
        assert (home / "pages" / "index.es.html").is_file()
        assert (home / "pages" / "index.pt.html").is_file()
        ran = subprocess.run(
            [tsc, "run", "--machine", "cpp", "-e", "SI|F(2, 80)"], env=variables, cwd=tmp_path,
            capture_output=True, text=True,
        )  # fmt: skip
        assert ran.returncode == 0, ran.stderr
        assert "2000 MOTORS 0 0" in ran.stdout
        completed_check = subprocess.run(
            [tsc, "check", "-e", "F(2 80)"], env=variables, capture_output=True
        )
        assert completed_check.returncode == 1
        make_older(home)


def make_older(home: Path) -> None:
    """Make the installation an older version, which does not work."""
    facts = next(home.rglob("tiniscript-*.dist-info"))
    older = facts.with_name("tiniscript-0.0.1.dist-info")
    version = facts.name.split("-")[1].removesuffix(".dist")
    for name, word in (("METADATA", f"Version: {version}"), ("RECORD", facts.name)):
        text = (facts / name).read_text("utf-8")
        assert word in text
        text = text.replace(word, "Version: 0.0.1" if name == "METADATA" else older.name)
        (facts / name).write_text(text, "utf-8")
    facts.rename(older)
    (facts.parent / "tiniscript" / "__init__.py").write_text("raise SystemExit('older')\n")


@pytest.mark.sampled(of="sticks that pip reads")
def test_a_stick_without_a_wheel_is_reported(stick: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    (empty / "wheels").mkdir(parents=True)
    shutil.copy(stick / "install.py", empty)
    completed = subprocess.run(
        [sys.executable, str(empty / "install.py"), str(tmp_path / "home")],
        capture_output=True, text=True, env={"LC_ALL": "C", "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    assert completed.returncode == 2
    assert "no packages for this computer" in completed.stderr


def test_every_link_of_the_pages_has_a_target(stick: Path) -> None:
    pages = stick / "pages"
    count = 0
    for page in pages.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'(src|href)="(//|http)[^"]*\.(js|css|woff)', text), page
        for path, anchor in re.findall(r'(?:href|src)="([^"#:]*)(#[^"]*)?"', text):
            target = (page.parent / path) if path else page
            assert target.is_file(), f"{page.name}: {path}"
            if anchor and target.suffix == ".html":
                target_text = target.read_text(encoding="utf-8")
                assert f'id="{unquote(anchor[1:])}"' in target_text, f"{page.name}: {path}{anchor}"
            count += 1
    assert count > 300
    for lesson_number in range(1, 15):
        for kind in ("en", "es", "teacher.en", "teacher.es"):
            assert (pages / "lessons" / f"{lesson_number:02}.{kind}.html").is_file()


def test_each_system_has_its_script_with_its_line_ends(stick: Path) -> None:
    for name in ("start.bat", "start.ps1"):
        data = (stick / name).read_bytes()
        assert data.count(b"\r\n") == data.count(b"\n") > 5
        data.decode("ascii")  # cmd reads a file in the code page of its console
    for name in ("start.sh", "start.command"):
        assert b"\r" not in (stick / name).read_bytes()
        assert (stick / name).stat().st_mode & 0o111
        assert subprocess.run(["sh", "-n", stick / name]).returncode == 0
    readme = (stick / "README.txt").read_text(encoding="utf-8-sig")
    lacks = (
        "BeOS: the ports ble:// and tcp:// will not work",
        "falta: BeOS: sin puertos",
        "falta: BeOS: sem portas",
    )
    assert all(lack in readme for lack in lacks)
    assert all(page in readme for page in ("index.html", "index.es.html", "index.pt.html"))


def test_the_script_of_windows_keeps_the_rules_of_cmd(stick: Path) -> None:
    """It checks only rules that can be read from the text, because the script is not run."""
    lines = (stick / "start.bat").read_text(encoding="ascii").splitlines()
    labels = {line[1:] for line in lines if line.startswith(":")} | {":eof"}
    for line in lines:
        if line.startswith("rem "):
            continue
        for target in re.findall(r"\bgoto (\S+)", line):
            assert target in labels, line
        # A folder's name may contain spaces, & and (, so that only quoted text is one word.
        plain = re.sub(r'set "\w+="', 'set "', line).replace('start ""', "start").replace('""', '"')
        outside = "".join(re.split(r'("[^"]*")', plain)[::2])
        assert not re.search(r"%(HERE|SETUP|USERPROFILE|LocalAppData)%|%%~fI", outside), line
        # a variable of the person's own is not ours
        for name in re.findall(r"if not defined (\w+)", line):
            assert f'set "{name}="' in lines, line
        # cmd removes the outer quotes unless they contain a single plain name.
        if line.startswith("cmd /k"):
            assert re.fullmatch(r'cmd /k ""[^"]+""', line)
    assert "/wait" in next(line for line in lines if "/passive" in line)


def test_nothing_of_this_computer_is_on_the_stick(stick: Path) -> None:
    for path in stick.rglob("*"):
        if path.suffix in (".html", ".txt", ".py", ".sh", ".bat", ".ps1", ".command"):
            text = path.read_text(encoding="utf-8-sig")
            assert str(ROOT) not in text, path
            assert "index-url" not in text, path


def test_an_unavailable_installer_is_named(tmp_path: Path) -> None:
    missing = usb_stick.add_installer(tmp_path, "file:///nowhere/python-3.13.9-amd64.exe")
    assert "by hand" in missing[0].sentence("en")
    assert "a mano" in missing[0].sentence("es")
    assert "No such file" in missing[0].reason
    page = tmp_path / "page.exe"
    page.write_text("<html>blocked by the school</html>")
    target = tmp_path / "stick"
    target.mkdir()
    assert "not that installer" in usb_stick.add_installer(target, page.as_uri())[0].reason
    assert list(target.iterdir()) == []
    digest = hashlib.sha256(page.read_bytes()).hexdigest()
    assert usb_stick.add_installer(target, page.as_uri(), digest) == []
    assert (target / "page.exe").is_file()
    page.write_bytes(page.read_bytes() + b" ")
    assert usb_stick.add_installer(target, page.as_uri(), digest)
    assert not (target / "page.exe").exists()


def test_the_pages_speak_one_language_and_have_boxes_to_tick(stick: Path) -> None:
    index = (stick / "pages" / "index.es.html").read_text(encoding="utf-8")
    assert "El lenguaje en una página" in index
    assert "Una clase en el estudio" in index
    assert "`" not in index
    materials = (stick / "pages" / "docs" / "es" / "materials.html").read_text(encoding="utf-8")
    assert materials.count('<li class="check">☐ ') == 8
    assert "[ ]" not in materials
    assert not re.search(r"Poster|Wiring|teacher</a>", index)


def test_a_phone_shows_each_teacher_page_completely(stick: Path) -> None:
    """Only the wiring is cut at 390 px, and it has a note about scrolling."""
    pages = [*sorted(stick.glob("pages/**/*.es.html")), stick / "pages" / "index.es.html"]
    cut = """[...document.querySelectorAll('pre, table, .finished')]
        .filter(each => each.scrollWidth > each.clientWidth + 1).length"""
    wide = "document.documentElement.scrollWidth > window.innerWidth"
    slides = "getComputedStyle(document.querySelector('.slide')).display"
    with studio.driver(needs_studio=False) as driver, studio.browser(driver) as browser:
        phone = browser.new_page(viewport={"width": 390, "height": 844})
        sizes = {}
        for page in pages:
            phone.goto(page.as_uri(), wait_until="domcontentloaded")
            sizes[page.name] = phone.evaluate(f"[{wide}, {cut}]")
            is_drawn = page.parent == stick / "pages" / "wiring"
            assert not is_drawn or phone.evaluate(slides) == "block"
    assert {name: value for name, value in sizes.items() if value != [False, 0]} == {}
    assert len(sizes) > 20


def test_a_folder_with_other_contents_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert usb_stick.main([str(tmp_path)]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def wheel(folder: Path, name: str, needs: Sequence[str] = (), tag: str = "py3-none-any") -> Path:
    """Make a wheel with nothing in it."""
    head = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n"
    head += "".join(f"Requires-Dist: {need}\n" for need in needs)
    path = folder / f"{name}-1-{tag}.whl"
    with zipfile.ZipFile(path, "w") as zip_file:
        zip_file.writestr(f"{name}-1.dist-info/METADATA", head)
        zip_file.writestr(f"{name}-1.dist-info/WHEEL", f"Wheel-Version: 1.0\nTag: {tag}\n")
        zip_file.writestr(f"{name}-1.dist-info/RECORD", "")
    return path


def fetch_packages(
    folder: Path, target: Path, system: str, python: str, package: str | Path
) -> set[str]:
    """Return the names of the packages that pip chooses from a folder for a system and a Python."""
    words = ["download", "--quiet", "--no-index", "--find-links", str(folder), "--dest",
             str(target), "--only-binary=:all:", "--python-version", python]  # fmt: skip
    for tag in SYSTEMS[system].tags:
        words += ["--platform", tag]
    stick_wheels._pip([*words, str(package)], SYSTEMS[system].markers(python))
    return {path.name for path in target.iterdir()}


@pytest.mark.sampled(of="sticks that pip reads")
def test_markers_are_those_of_the_target(tmp_path: Path) -> None:
    """pip resolves additional packages for Windows, and for an old Python."""
    for name in ("only_windows", "only_old"):
        wheel(tmp_path, name)
    needs = ["only_windows; sys_platform == 'win32'", "only_old; python_version < '3.11'"]
    own_wheel = wheel(tmp_path, "robot", needs)
    for system, python, expected_names in (
        ("windows", "3.10", {"only_windows", "only_old"}),
        ("windows", "3.12", {"only_windows"}),
        ("mac-apple", "3.10", {"only_old"}),
    ):
        names = fetch_packages(tmp_path, tmp_path / f"{system}{python}", system, python, own_wheel)
        assert {name.split("-")[0] for name in names} == {"robot", *expected_names}


def test_linux_gets_the_wheel_with_the_parts_in_c(tmp_path: Path) -> None:
    """wasmtime has one for manylinux1 and one of Python alone, which does not run."""
    wheel(tmp_path, "robot")
    path = wheel(tmp_path, "robot", tag="py3-none-manylinux1_x86_64")
    assert fetch_packages(tmp_path, tmp_path / "target", "linux", "3.12", "robot") == {path.name}


def test_a_wheel_without_its_parts_in_c_is_for_every_system(tmp_path: Path) -> None:
    old_wheel = tmp_path / "thing-1-cp311-cp311-linux_x86_64.whl"
    metadata = "Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: cp311-cp311-linux_x86_64\n"
    files = {"thing/__init__.py": "", "thing/fast.cpython-311-x86_64-linux-gnu.so": "x",
             "thing-1.dist-info/WHEEL": metadata, "thing-1.dist-info/RECORD": ""}  # fmt: skip
    with zipfile.ZipFile(old_wheel, "w") as wheel:
        for name, text in files.items():
            wheel.writestr(zipfile.ZipInfo(name, (2020, 1, 2, 3, 4, 6)), text)
    with zipfile.ZipFile(old_wheel) as wheel:
        when = wheel.infolist()[0].date_time
    path = stick_wheels.without_parts_in_c(old_wheel, tmp_path)
    assert path.name == "thing-1-py3-none-any.whl"
    with zipfile.ZipFile(path) as wheel:
        assert {row.date_time for row in wheel.infolist()} == {when}, "another time, other bytes"
        assert not [path for path in wheel.namelist() if path.endswith(".so")]
        metadata = wheel.read("thing-1.dist-info/WHEEL").decode()
        assert "Root-Is-Purelib: true" in metadata
        assert re.findall(r"(?m)^Tag: (.*)$", metadata) == ["py3-none-any"]
        record = wheel.read("thing-1.dist-info/RECORD").decode()
    assert len(record.splitlines()) == 3


def test_a_stick_is_for_each_python_that_tsc_is_for() -> None:
    assert PYTHONS[0] == "3.10"
    assert [int(version.split(".")[1]) for version in PYTHONS] == list(range(10, 10 + len(PYTHONS)))
    title = usb_stick.__doc__ or ""
    assert f"Python {PYTHONS[0]} to {PYTHONS[-1]}" in title
