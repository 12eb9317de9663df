// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "bindings/bindings.h"
#include "bindings/convert.h"
#include "bindings/deferred_release.h"
#include "shadow_layers/error.h"

namespace shadow_layers::bindings {
namespace {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));

void require_open(const PyScene& self, const char* method) {
    if (self.frozen) {
        throw InputError(std::string("Scene.") + method +
                         ": the scene was given to a render and takes no more; make a new Scene (unchanged meshes stay "
                         "in the session's cache)");
    }
}

std::size_t add_mesh(PyScene& self, std::string name, const py::object& positions, const py::object& triangles) {
    require_open(self, "add_mesh");
    const std::string place = "Scene.add_mesh('" + name + "'): ";
    const py::array points =
        require_array((place + "positions").c_str(), positions, {'f', 4, {-1, 3}, "float32 (n, 3)"});
    const py::array indices =
        require_array((place + "triangles").c_str(), triangles, {'u', 4, {-1, 3}, "uint32 (m, 3)"});
    // The keys are of the content now, and the indices are checked now: neither may change under the core.
    points.attr("setflags")(py::arg("write") = false);
    indices.attr("setflags")(py::arg("write") = false);
    const std::span points_span(static_cast<const glm::vec3*>(points.data()), std::size_t(points.shape(0)));
    const std::span indices_span(static_cast<const glm::uvec3*>(indices.data()), std::size_t(indices.shape(0)));
    auto owner = hold_until_unused({points, indices});
    std::shared_ptr<const Mesh> mesh;
    {
        GilRelease release;
        mesh = make_mesh(std::move(name), points_span, indices_span, std::move(owner));
    }
    require_open(self, "add_mesh");  // another thread may have rendered the scene meanwhile
    self.scene->meshes.push_back(std::move(mesh));
    return self.scene->meshes.size() - 1;
}

void set_instances(PyScene& self, const py::object& mesh, const py::object& world_from_object, const py::object& flags,
                   const py::object& receiver_group, const py::object& blocker_group) {
    require_open(self, "set_instances");
    const py::array meshes = require_array("Scene.set_instances: mesh", mesh, {'u', 4, {-1}, "uint32 (n,)"});
    const py::ssize_t count = meshes.shape(0);
    const std::string number = std::to_string(count);
    const py::array matrices = require_array("Scene.set_instances: world_from_object", world_from_object,
                                             {'f', 8, {count, 4, 4}, ("float64 (" + number + ", 4, 4)").c_str()});
    const std::string flags_text = "uint32 (" + number + ",)", group_text = "uint8 (" + number + ",)";
    const py::array flag_array =
        require_array("Scene.set_instances: flags", flags, {'u', 4, {count}, flags_text.c_str()});
    const auto groups = [&](const char* argument, const py::object& value) -> std::optional<py::array> {
        if (value.is_none()) return std::nullopt;
        return require_array(argument, value, {'u', 1, {count}, group_text.c_str()});
    };
    const auto receivers = groups("Scene.set_instances: receiver_group", receiver_group);
    const auto blockers = groups("Scene.set_instances: blocker_group", blocker_group);

    std::vector<Instance> instances(static_cast<std::size_t>(count));
    const auto* mesh_data = static_cast<const std::uint32_t*>(meshes.data());
    const auto* matrix_data = static_cast<const double*>(matrices.data());
    const auto* flag_data = static_cast<const std::uint32_t*>(flag_array.data());
    for (std::size_t i = 0; i < instances.size(); ++i) {
        Instance& instance = instances[i];
        instance.mesh = mesh_data[i];
        instance.flags = flag_data[i];
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                instance.world_from_object[column][row] = matrix_data[i * 16 + std::size_t(row * 4 + column)];
            }
        }
        if (receivers) instance.receiver_group = static_cast<const std::uint8_t*>(receivers->data())[i];
        if (blockers) instance.blocker_group = static_cast<const std::uint8_t*>(blockers->data())[i];
    }
    self.scene->instances = std::move(instances);
}

std::size_t add_light(PyScene& self, std::string name, const std::string& kind, const py::object& world_from_light,
                      const py::object& color, double energy, double radius, double sun_angle, double spot_angle,
                      double spot_blend, const py::object& area_size, bool area_round, bool casts_shadow,
                      const py::object& receiver_set, const py::object& blocker_set, const py::object& spot_scale) {
    require_open(self, "add_light");
    const std::string place = "Scene.add_light('" + name + "'): ";
    const auto rgb = numbers_from((place + "color").c_str(), color, 3);
    const auto size = numbers_from((place + "area_size").c_str(), area_size, 2);
    const auto cone = numbers_from((place + "spot_scale").c_str(), spot_scale, 2);
    Light light;
    light.name = std::move(name);
    light.kind = light_kind_from(kind);
    light.world_from_light = matrix_from((place + "world_from_light").c_str(), world_from_light);
    light.color = glm::vec3(float(rgb[0]), float(rgb[1]), float(rgb[2]));
    light.energy = energy;
    light.radius = radius;
    light.sun_angle = sun_angle;
    light.spot_angle = spot_angle;
    light.spot_blend = spot_blend;
    light.spot_scale = {cone[0], cone[1]};
    light.area_size = {size[0], size[1]};
    light.area_round = area_round;
    light.casts_shadow = casts_shadow;
    light.receiver_set = bits_from((place + "receiver_set").c_str(), receiver_set);
    light.blocker_set = bits_from((place + "blocker_set").c_str(), blocker_set);
    self.scene->lights.push_back(std::move(light));
    return self.scene->lights.size() - 1;
}

std::size_t triangle_count(const PyScene& self) {
    std::size_t count = 0;
    for (const Instance& instance : self.scene->instances) {
        if (instance.mesh < self.scene->meshes.size()) count += self.scene->meshes[instance.mesh]->triangles.size();
    }
    return count;
}

}  // namespace

void bind_scene(py::module_& module) {
    module.attr("INSTANCE_CAMERA") = py::int_(std::uint32_t(kInstanceCamera));
    module.attr("INSTANCE_SHADOW") = py::int_(std::uint32_t(kInstanceShadow));
    module.attr("INSTANCE_HOLDOUT") = py::int_(std::uint32_t(kInstanceHoldout));
    const Light defaults;
    py::class_<PyScene>(module, "Scene", py::module_local(), "Filled once, then given to any number of renders.")
        .def(py::init([] {
            release_deferred();
            return std::make_unique<PyScene>();
        }))
        .def(
            "add_mesh", &add_mesh, py::arg("name"), py::arg("positions"), py::arg("triangles"),
            "positions (n, 3) float32 object space; triangles (m, 3) uint32. Returns the mesh's index. Both arrays are "
            "kept, not copied, and made read-only.")
        .def("set_instances", &set_instances, py::arg("mesh"), py::arg("world_from_object"), py::arg("flags"),
             py::arg("receiver_group") = py::none(), py::arg("blocker_group") = py::none(),
             "All instances at once: (n,), (n, 4, 4), (n,), (n,), (n,).")
        .def("add_light", &add_light, py::arg("name"), py::arg("kind"), py::arg("world_from_light"), py::kw_only(),
             py::arg("color") = py::make_tuple(1, 1, 1), py::arg("energy") = defaults.energy,
             py::arg("radius") = defaults.radius, py::arg("sun_angle") = defaults.sun_angle,
             py::arg("spot_angle") = defaults.spot_angle, py::arg("spot_blend") = defaults.spot_blend,
             py::arg("area_size") = py::make_tuple(1, 1), py::arg("area_round") = false, py::arg("casts_shadow") = true,
             py::arg("receiver_set") = py::int_(kAllGroups), py::arg("blocker_set") = py::int_(kAllGroups),
             py::arg("spot_scale") = py::make_tuple(1, 1), "Returns the light's index.")
        .def_property_readonly("triangle_count", &triangle_count, "Over all instances.");
}

}  // namespace shadow_layers::bindings
