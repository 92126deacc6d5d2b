# SPDX-License-Identifier: Apache-2.0
"""What pip asks to make a wheel (PEP 517) of the package as CMake built it: its modules, and beside them the shared libraries."""
import base64
import hashlib
import pathlib
import sysconfig
import zipfile

HERE = pathlib.Path(__file__).resolve().parent


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Write the wheel; returns its file name."""
    if not (HERE / "METADATA").exists() or not list((HERE / "tactus").glob("*.so.*")):
        raise SystemExit(f"{HERE} holds no built package; build the target tactus_python and name its folder: BUILD/bindings/python")
    metadata = (HERE / "METADATA").read_text()
    name, version = (next(line.split()[1] for line in metadata.splitlines() if line.startswith(f"{field}:")) for field in ("Name", "Version"))
    stem = f"{name.replace('-', '_')}-{version}"
    tag = f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    info = f"{stem}.dist-info"
    files = {f"tactus/{path.name}": path.read_bytes() for path in sorted((HERE / "tactus").iterdir()) if path.is_file()}
    files[f"{info}/METADATA"] = metadata.encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: tactus\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = "".join(f"{file},sha256={digest(data)},{len(data)}\n" for file, data in files.items())
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = f"{stem}-{tag}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for file, data in files.items():
            archive.writestr(file, data)
    return wheel


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
