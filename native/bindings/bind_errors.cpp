// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/bindings.h"
#include "shadow_layers/error.h"

namespace shadow_layers::bindings {
namespace {

// Bound to this module alone: the translators of other pybind11 modules in the process must not see our exceptions.
template <class CppError>
py::object bind_error(py::module_& module, const char* name, const py::handle& base, const char* doc) {
    py::object python_class = py::register_local_exception<CppError>(module, name, base);
    python_class.attr("__doc__") = doc;
    return python_class;
}

}  // namespace

// Translators are asked in reverse order, so the base class comes first.
void bind_errors(py::module_& module) {
    const py::object error =
        bind_error<Error>(module, "Error", PyExc_RuntimeError, "Base of everything that the core raises.");
    bind_error<InputError>(module, "InputError", error, "Data that cannot be rendered; names it and the remedy.");
    bind_error<ContextError>(module, "ContextError", error, "No GL context; lists what was tried and what to install.");
    bind_error<ShaderError>(module, "ShaderError", error, "A shader is missing or does not compile; has file:line.");
    bind_error<DriverError>(module, "DriverError", error, "The driver refused: a limit, memory, or a GL error.");
    bind_error<Cancelled>(module, "Cancelled", error, "The render was cancelled; nothing of its frame is returned.");
}

}  // namespace shadow_layers::bindings
