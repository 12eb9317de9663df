// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/bindings.h"
#include "bindings/convert.h"

namespace shadow_layers::bindings {

void bind_camera(py::module_& module) {
    const auto make = [](bool perspective, const py::object& window, double clip_start, double clip_end,
                         const py::object& world_from_camera) {
        const auto sides = numbers_from("Camera: window", window, 4);
        Camera camera;
        camera.perspective = perspective;
        camera.window = {sides[0], sides[1], sides[2], sides[3]};
        camera.clip_start = clip_start;
        camera.clip_end = clip_end;
        camera.world_from_camera = matrix_from("Camera: world_from_camera", world_from_camera);
        validate(camera);
        return camera;
    };
    py::class_<Camera>(module, "Camera", py::module_local(), "A pinhole or orthographic camera; looks along its -Z.")
        .def(py::init(make), py::kw_only(), py::arg("perspective"), py::arg("window"), py::arg("clip_start"),
             py::arg("clip_end"), py::arg("world_from_camera"),
             "window: left, right, bottom, top at view depth 1, or in scene units if orthographic.");
}

}  // namespace shadow_layers::bindings
