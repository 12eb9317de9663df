// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>

#include "shadow_layers/camera.h"
#include "shadow_layers/scene.h"

namespace shadow_layers::bindings {

namespace py = pybind11;

// One bind_*.cpp each. Classes are module_local: another module in the process may use pybind11 too.
void bind_errors(py::module_& module);
void bind_techniques(py::module_& module);
void bind_scene(py::module_& module);
void bind_camera(py::module_& module);
void bind_session(py::module_& module);

/// The Python class `Scene`. Once it was given to a render it may be read by another thread, so it takes no more.
struct PyScene {
    std::shared_ptr<Scene> scene = std::make_shared<Scene>();
    bool frozen = false;
};

/// Waits until the process ends. At the interpreter's end Python ends a daemon thread that asks for the GIL by
/// unwinding it (pthread_exit); our frames hold Python references that must not be dropped without the GIL, so the
/// unwinding is caught and goes no further.
[[noreturn]] void hang_until_exit();

/// Lets other Python threads run while it lives.
class GilRelease {
public:
    GilRelease() : state_(PyEval_SaveThread()) {}
    ~GilRelease() {
        try {
            PyEval_RestoreThread(state_);
        } catch (abi::__forced_unwind&) {
            hang_until_exit();
        }
    }
    GilRelease(const GilRelease&) = delete;
    GilRelease& operator=(const GilRelease&) = delete;

private:
    PyThreadState* state_;
};

}  // namespace shadow_layers::bindings
