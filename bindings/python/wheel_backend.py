"""Builds the wheel (PEP 517) with the standard library and cargo.

The shared library is loaded by ctypes, so the wheel is for every Python and one platform.

``FIELDWALK_LIBRARY`` and ``FIELDWALK_GENERATED`` name a built library and the folder of its generated sources; without
them both are made here, in the release profile.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
#: The earliest time that a zip archive can name: the same sources give the same wheel.
EPOCH = (1980, 1, 1, 0, 0, 0)
LIBRARY_NAMES = {"darwin": "libfieldwalk_ffi.dylib", "win32": "fieldwalk_ffi.dll"}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel into ``wheel_directory`` and gives its name."""
    library, generated = _built()
    version = _version()
    platform = re.sub(r"[^0-9A-Za-z]", "_", sysconfig.get_platform())
    tag = f"py3-none-{platform}"
    info = f"fieldwalk-{version}.dist-info"
    files = {f"fieldwalk/{path.name}": path.read_bytes() for path in sorted((HERE / "fieldwalk").iterdir()) if path.is_file()}
    files.update({f"fieldwalk/{path.name}": path.read_bytes() for path in sorted(generated.glob("*.py"))})
    files[f"fieldwalk/{library.name}"] = library.read_bytes()
    for licence in ("LICENSE-MIT", "LICENSE-APACHE", "NOTICE"):
        files[f"{info}/licenses/{licence}"] = (ROOT / licence).read_bytes()
    files[f"{info}/METADATA"] = _metadata(version).encode()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: fieldwalk\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    )
    record = "".join(f"{name},sha256={_digest(content)},{len(content)}\n" for name, content in files.items())
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    name = f"fieldwalk-{version}-{tag}.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path, EPOCH)
            entry.external_attr = 0o644 << 16
            wheel.writestr(entry, content, zipfile.ZIP_DEFLATED, 6)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """There is none: the sources of the library are not below this folder."""
    raise NotImplementedError("build a wheel, in a checkout of the whole repository")


def _built():
    """The library and the folder of generated sources."""
    library, generated = os.environ.get("FIELDWALK_LIBRARY"), os.environ.get("FIELDWALK_GENERATED")
    if library and generated:
        return Path(library), Path(generated)
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    cargo = os.environ.get("CARGO", "cargo")
    # Without line tables the library is a tenth as large.
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target), "CARGO_PROFILE_RELEASE_DEBUG": "0"}

    def run(*arguments):
        subprocess.run([cargo, *arguments], cwd=ROOT, env=environment, check=True)

    run("build", "--release", "--package", "fieldwalk-ffi", "--lib")
    library = target / "release" / LIBRARY_NAMES.get(sys.platform, "libfieldwalk_ffi.so")
    generated = target / "bindings" / "python"
    generator = ["run", "--profile", "generator", "--package", "fieldwalk-bindgen", "--", "python"]
    run(*generator, str(library), str(generated), str(HERE / "surface.txt"))
    return library, generated


def _version():
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    return re.search(r'^\[workspace\.package\]\s*^version = "([^"]+)"', manifest, re.MULTILINE).group(1)


def _metadata(version):
    """What ``pyproject.toml`` says, in the form that installers read."""
    project = (HERE / "pyproject.toml").read_text(encoding="utf-8")

    def field(name):
        return re.search(rf'^{name} = "(.*)"$', project, re.MULTILINE).group(1)

    requirements = re.search(r"^dependencies = \[(.*)\]$", project, re.MULTILINE).group(1)
    lines = [
        "Metadata-Version: 2.4",
        "Name: fieldwalk",
        f"Version: {version}",
        f"Summary: {field('description')}",
        f"License-Expression: {field('license')}",
        f"Requires-Python: {field('requires-python')}",
        *(f"Requires-Dist: {name}" for name in re.findall(r'"([^"]+)"', requirements)),
        "Description-Content-Type: text/markdown",
    ]
    return "\n".join(lines) + "\n\n" + (HERE / "README.md").read_text(encoding="utf-8")


def _digest(content):
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
