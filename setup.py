"""Lets CMake compile the module, and puts beside it what it opens: scenes, shaders, the reader of surfaces."""

import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        package = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve().parent
        build = pathlib.Path(self.build_temp).resolve()
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O2", "-DCMAKE_UNITY_BUILD=ON",
                   "-DCMAKE_UNITY_BUILD_BATCH_SIZE=10", "-DSUPPLE_TESTS=OFF", "-DSUPPLE_PYTHON=ON",
                   f"-DPython3_EXECUTABLE={sys.executable}", *os.environ.get("CMAKE_ARGS", "").split()]
        try:
            import pybind11

            options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
        except ImportError:
            pass  # Debian's pybind11-dev is found without it
        subprocess.run(["cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", *options], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "supple_python", "supple-read-surface",
                        "--parallel", str(os.cpu_count())], check=True)
        package.mkdir(parents=True, exist_ok=True)
        (module,) = (build / "python/supple").glob("_supple*.so")
        shutil.copy(module, package)
        shutil.copy(build / "supple-read-surface", package)
        for folder in ("assets", "shaders"):
            shutil.copytree(SOURCE / folder, package / folder, dirs_exist_ok=True)


setup(ext_modules=[Extension("supple._supple", [])], cmdclass={"build_ext": BuildWithCMake})
