"""The version of the package."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("dynoid")
except PackageNotFoundError:
    __version__ = "0"
