// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <thread>

#include "bindings/bindings.h"
#include "shadow_layers/session.h"

namespace shadow_layers::bindings {

void hang_until_exit() {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

}  // namespace shadow_layers::bindings

PYBIND11_MODULE(shadow_core, module) {
    using namespace shadow_layers;
    module.doc() = "The native core of Shadow Layers: shadows of every light as image layers.";
    module.attr("__version__") = version();
    module.attr("__revision__") = revision();
    bindings::bind_errors(module);
    bindings::bind_techniques(module);
    bindings::bind_scene(module);
    bindings::bind_camera(module);
    bindings::bind_session(module);
}
