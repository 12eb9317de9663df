# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Finds pybind11's CMake package. It comes from PyPI (requirements/), because Debian's 2.10 does not work with NumPy 2.
# Order: -Dpybind11_DIR, then -DSHADOW_LAYERS_TOOLS_PYTHON, the environment of scripts/setup.sh, ${Python_EXECUTABLE}.
set(SHADOW_LAYERS_TOOLS_PYTHON "" CACHE FILEPATH "A Python that has pybind11 >= 2.13 (build only)")
find_package(Python 3.10 COMPONENTS Interpreter Development.Module REQUIRED)

# --- no pybind11 may be found by chance: Debian's would be ---
if(NOT pybind11_DIR)
    execute_process(COMMAND ${CMAKE_SOURCE_DIR}/scripts/setup.sh --python tools
                    OUTPUT_VARIABLE setup_python OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    foreach(candidate ${SHADOW_LAYERS_TOOLS_PYTHON} ${setup_python} ${Python_EXECUTABLE})
        execute_process(COMMAND ${candidate} -m pybind11 --cmakedir
                        OUTPUT_VARIABLE cmake_dir OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
        if(NOT failed AND IS_DIRECTORY "${cmake_dir}")
            set(pybind11_DIR ${cmake_dir} CACHE PATH "Folder of pybind11Config.cmake")
            break()
        endif()
    endforeach()
endif()
if(NOT pybind11_DIR)
    message(FATAL_ERROR "No pybind11 >= 2.13 found. Run 'scripts/setup.sh build'; or give "
        "-DSHADOW_LAYERS_TOOLS_PYTHON=<a Python after 'pip install pybind11==2.13.6'>; or build without the Python "
        "module: -DSHADOW_LAYERS_PYTHON=OFF")
endif()
