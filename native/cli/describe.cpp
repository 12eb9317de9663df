// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/describe.h"

#include <cmath>
#include <sstream>

#include "shadow_layers/names.h"

namespace shadow_layers::cli {
namespace {

std::string value_text(const ParameterValue& value) {
    std::ostringstream text;
    std::visit([&](const auto& held) { text << std::boolalpha << held; }, value);
    return text.str();
}

std::string limits_text(const ParameterSpec& spec) {
    std::ostringstream text;
    switch (spec.type) {
        case ParameterType::Bool:
            return "false | true";
        case ParameterType::Enum:
            for (const EnumItem& item : spec.items) text << (&item == &spec.items.front() ? "" : " | ") << item.id;
            return text.str();
        case ParameterType::Int:
        case ParameterType::Float:
            break;
    }
    text << spec.min << " to " << spec.max;
    if (spec.type == ParameterType::Int && spec.step != 1) text << " in steps of " << spec.step;
    if (!spec.unit.empty()) text << " " << spec.unit;
    return text.str();
}

nlohmann::json value_to_json(const ParameterValue& value) {
    return std::visit([](const auto& held) { return nlohmann::json(held); }, value);
}

nlohmann::json parameter_to_json(const ParameterSpec& spec) {
    nlohmann::json items = nlohmann::json::array();
    for (const EnumItem& item : spec.items)
        items.push_back({{"id", item.id}, {"label", item.label}, {"help", item.help}});
    return {{"id", spec.id},
            {"label", spec.label},
            {"type", get_name(spec.type)},
            {"default", value_to_json(spec.default_value)},
            {"min", spec.min},
            {"max", spec.max},
            {"step", spec.step},
            {"unit", spec.unit},
            {"help", spec.help},
            {"items", items},
            {"shared", spec.shared}};
}

nlohmann::json times_to_json(const RenderStats& stats, double StageTime::*member) {
    nlohmann::json times = nlohmann::json::object();
    for (const StageTime& time : stats.times) {
        if (time.*member >= 0) times[time.stage] = round_ms(times.value(time.stage, 0.0) + time.*member);
    }
    return times;
}

}  // namespace

std::string describe_techniques() {
    std::ostringstream text;
    text << "Techniques and their parameters (--set T.P=V):";
    for (const TechniqueDescriptor& descriptor : technique_descriptors()) {
        if (descriptor.test_only) continue;
        text << "\n\n  " << descriptor.id << ": " << descriptor.label << ". " << descriptor.summary
             << "\n    limits: " << descriptor.limits;
        for (const std::string& restriction : list_restrictions(descriptor)) text << "\n    " << restriction;
        for (const ParameterSpec& spec : descriptor.parameters) {
            text << "\n    " << descriptor.id << "." << spec.id << "=" << value_text(spec.default_value) << "  ("
                 << limits_text(spec) << ")  " << spec.help;
        }
    }
    return text.str();
}

double round_ms(double ms) { return std::round(ms * 1e4) / 1e4; }

nlohmann::json versions_to_json(const SessionInfo& info) {
    return {
        {"program", "shadowcore"}, {"shadow_layers", version()},      {"revision", revision()},       {"blender", ""},
        {"backend", info.backend}, {"gl_renderer", info.gl_renderer}, {"gl_version", info.gl_version}};
}

nlohmann::json technique_to_json(const TechniqueDescriptor& descriptor) {
    nlohmann::json lights = nlohmann::json::array(), parameters = lights, outputs = lights;
    for (const LightKind kind : descriptor.lights) lights.push_back(get_name(kind));
    for (const ParameterSpec& spec : descriptor.parameters) parameters.push_back(parameter_to_json(spec));
    for (const OutputSpec& output : descriptor.outputs) {
        outputs.push_back(
            {{"id", output.id}, {"label", output.label}, {"channels", output.channels}, {"help", output.help}});
    }
    return {{"id", descriptor.id},
            {"label", descriptor.label},
            {"summary", descriptor.summary},
            {"reference", descriptor.reference},
            {"meshes", get_name(descriptor.meshes)},
            {"light_size", get_name(descriptor.light_size)},
            {"alpha_cutouts", descriptor.alpha_cutouts},
            {"restrictions", list_restrictions(descriptor)},
            {"limits", descriptor.limits},
            {"lights", lights},
            {"parameters", parameters},
            {"outputs", outputs},
            {"truth", get_name(find_truth(descriptor, resolve_parameters(descriptor, {})).kind)},
            {"test_only", descriptor.test_only}};
}

nlohmann::json parameters_to_json(const ParameterValues& values) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [id, value] : values.all()) json[id] = value_to_json(value);
    return json;
}

nlohmann::json cpu_times_to_json(const RenderStats& stats) { return times_to_json(stats, &StageTime::cpu_ms); }
nlohmann::json gl_times_to_json(const RenderStats& stats) { return times_to_json(stats, &StageTime::gl_ms); }

}  // namespace shadow_layers::cli
