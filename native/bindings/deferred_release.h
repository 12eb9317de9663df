// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

namespace shadow_layers::bindings {

/// Keeps Python objects alive for C++ code that knows nothing of Python. The last owner may die on any thread, also on
/// the session's worker, which must never wait for the GIL (a thread that holds it may be waiting for the worker). So
/// the references are not dropped there but queued, and dropped by the next Python thread that comes by.
/// The GIL must be held.
std::shared_ptr<const void> hold_until_unused(std::vector<pybind11::object> objects);

/// Drops what is queued. The GIL must be held. Called on every way out of the module, and by the interpreter's
/// pending calls where none comes.
void release_deferred();

}  // namespace shadow_layers::bindings
