// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <variant>

#include "bindings/bindings.h"
#include "bindings/convert.h"
#include "shadow_layers/names.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers::bindings {
namespace {

py::dict parameter_info(const ParameterSpec& spec) {
    py::dict info;
    info["id"] = spec.id;
    info["label"] = spec.label;
    info["type"] = get_name(spec.type);
    info["default"] = std::visit([](const auto& value) -> py::object { return py::cast(value); }, spec.default_value);
    info["min"] = spec.min;
    info["max"] = spec.max;
    info["step"] = spec.step;
    info["unit"] = spec.unit;
    info["help"] = spec.help;
    py::list items;
    for (const EnumItem& item : spec.items) {
        py::dict entry;
        entry["id"] = item.id;
        entry["label"] = item.label;
        entry["help"] = item.help;
        items.append(entry);
    }
    info["items"] = items;
    info["shared"] = spec.shared;
    return info;
}

py::dict output_info(const OutputSpec& output) {
    py::dict info;
    info["id"] = output.id;
    info["label"] = output.label;
    info["channels"] = output.channels;
    info["help"] = output.help;
    return info;
}

py::dict technique_info(const TechniqueDescriptor& descriptor) {
    py::dict info;
    info["id"] = descriptor.id;
    info["label"] = descriptor.label;
    info["summary"] = descriptor.summary;
    info["reference"] = descriptor.reference;
    info["meshes"] = get_name(descriptor.meshes);
    info["light_size"] = get_name(descriptor.light_size);
    info["alpha_cutouts"] = descriptor.alpha_cutouts;
    info["limits"] = descriptor.limits;
    py::list lights, parameters, outputs, restrictions;
    for (const LightKind kind : descriptor.lights) lights.append(get_name(kind));
    for (const ParameterSpec& spec : descriptor.parameters) parameters.append(parameter_info(spec));
    for (const std::string& text : list_restrictions(descriptor)) restrictions.append(text);
    for (const OutputSpec& output : descriptor.outputs) outputs.append(output_info(output));
    info["lights"] = lights;
    info["restrictions"] = restrictions;
    info["parameters"] = parameters;
    info["outputs"] = outputs;
    info["truth"] = get_name(find_truth(descriptor, resolve_parameters(descriptor, {})).kind);
    info["test_only"] = descriptor.test_only;
    return info;
}

py::list techniques() {
    py::list list;
    for (const TechniqueDescriptor& descriptor : technique_descriptors()) list.append(technique_info(descriptor));
    return list;
}

py::dict resolve(const std::string& technique, const py::object& given) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(technique);
    return parameters_to(resolve_parameters(descriptor, parameters_from("given", given)));
}

py::dict truth(const std::string& technique, const py::object& given) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(technique);
    const TruthSpec spec = find_truth(descriptor, resolve_parameters(descriptor, parameters_from("given", given)));
    py::dict info;
    info["kind"] = get_name(spec.kind);
    info["footprint_texels"] = spec.footprint_texels;
    info["footprint_world"] = spec.footprint_world;
    return info;
}

}  // namespace

void bind_techniques(py::module_& module) {
    module.def("techniques", &techniques, "All techniques as data, in menu order.");
    module.def("resolve_parameters", &resolve, py::arg("technique"), py::arg("given"),
               "Defaults filled in and values checked; InputError names technique, parameter, value and range.");
    module.def("get_truth", &truth, py::arg("technique"), py::arg("given"),
               "Which exact picture a layer with these parameters stands for.");
}

}  // namespace shadow_layers::bindings
