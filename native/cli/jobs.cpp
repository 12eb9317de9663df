// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/jobs.h"

#include <algorithm>
#include <charconv>

#include "shadow_layers/error.h"

namespace shadow_layers::cli {
namespace {

using io::SceneFile;

template <class T>
T parse_number(const std::string& place, const std::string& text, const char* kind) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
        throw InputError(place + ": '" + text + "' is no " + kind);
    }
    return value;
}

const ParameterSpec* find_spec(const TechniqueDescriptor& descriptor, const std::string& id) {
    const auto found = std::find_if(descriptor.parameters.begin(), descriptor.parameters.end(),
                                    [&](const ParameterSpec& spec) { return spec.id == id; });
    return found == descriptor.parameters.end() ? nullptr : &*found;
}

const ParameterSpec& require_spec(const Setting& setting) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(setting.technique);
    if (const ParameterSpec* spec = find_spec(descriptor, setting.parameter)) return *spec;
    std::string known;
    for (const ParameterSpec& spec : descriptor.parameters) known += (known.empty() ? "" : ", ") + spec.id;
    throw InputError("--set " + setting.text + ": " + setting.technique + " has no parameter '" + setting.parameter +
                     "'; it has: " + known);
}

bool serves(const TechniqueDescriptor& descriptor, LightKind kind) {
    return std::find(descriptor.lights.begin(), descriptor.lights.end(), kind) != descriptor.lights.end();
}

bool contains(const std::vector<std::uint32_t>& lights, std::uint32_t light) {
    return std::find(lights.begin(), lights.end(), light) != lights.end();
}

// What the command line says of a job's technique, over what the job has already.
void apply_settings(const Options& options, LayerJob& job) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(job.technique);
    if (!options.map_sizes.empty() && find_spec(descriptor, "map_size")) {
        job.parameters.set("map_size", std::int64_t(options.map_sizes.front()));
    }
    for (const Setting& setting : options.settings) {
        const ParameterSpec& spec = require_spec(setting);
        if (setting.technique == job.technique) {
            job.parameters.set(spec.id, parse_value(job.technique, spec, setting.values.front()));
        }
    }
    resolve_parameters(descriptor, job.parameters);  // checks before anything is rendered
}

// The parameters that the snapshot's job of this light and technique has, if there is one.
ParameterValues find_parameters(const SceneFile& file, std::uint32_t light, const std::string& technique) {
    for (const LayerJob& job : file.jobs) {
        if (job.light == light && job.technique == technique) return job.parameters;
    }
    return {};
}

}  // namespace

ParameterValue parse_value(const std::string& technique, const ParameterSpec& spec, const std::string& text) {
    const std::string place = technique + "." + spec.id;
    switch (spec.type) {
        case ParameterType::Bool:
            for (const char* word : {"true", "on", "yes", "1"}) {
                if (text == word) return true;
            }
            for (const char* word : {"false", "off", "no", "0"}) {
                if (text == word) return false;
            }
            throw InputError(place + ": '" + text + "' is neither true nor false");
        case ParameterType::Int:
            return parse_number<std::int64_t>(place, text, "whole number");
        case ParameterType::Float:
            return parse_number<double>(place, text, "number");
        case ParameterType::Enum:
            break;
    }
    return text;
}

std::vector<std::uint32_t> choose_lights(const SceneFile& file, const std::vector<std::string>& names) {
    const auto& lights = file.scene->lights;
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; names.empty() && i < lights.size(); ++i) chosen.push_back(i);
    for (const std::string& name : names) {
        bool found = false;
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            if (lights[i].name != name) continue;
            found = true;
            if (!contains(chosen, i)) chosen.push_back(i);
        }
        if (found) continue;
        std::string known;
        for (const Light& light : lights) known += (known.empty() ? "" : ", ") + ("'" + light.name + "'");
        throw InputError("--lights: the file has no light '" + name + "'; it has: " + known);
    }
    return chosen;
}

std::vector<std::string> choose_techniques(const Options& options) {
    if (!options.techniques.empty()) return options.techniques;
    std::vector<std::string> all;
    for (const TechniqueDescriptor& descriptor : technique_descriptors()) {
        if (!descriptor.test_only) all.push_back(descriptor.id);
    }
    return all;
}

std::vector<LayerJob> make_jobs(const SceneFile& file, const Options& options, std::vector<std::string>& warnings) {
    const std::vector<std::uint32_t> lights = choose_lights(file, options.lights);
    std::vector<LayerJob> jobs;
    if (options.techniques.empty() && !file.jobs.empty()) {
        std::copy_if(file.jobs.begin(), file.jobs.end(), std::back_inserter(jobs),
                     [&](const LayerJob& job) { return contains(lights, job.light); });
    } else {
        for (const std::uint32_t light : lights) {
            for (const std::string& id : choose_techniques(options)) {
                const TechniqueDescriptor& descriptor = find_technique_descriptor(id);
                if (serves(descriptor, file.scene->lights[light].kind)) {
                    jobs.push_back({light, id, find_parameters(file, light, id)});
                } else {
                    warnings.push_back(descriptor.label + " does not serve the kind of light '" +
                                       file.scene->lights[light].name + "': it has no layer of it");
                }
            }
        }
    }
    for (const Setting& setting : options.settings) require_spec(setting);
    for (LayerJob& job : jobs) apply_settings(options, job);
    if (jobs.empty()) throw InputError("there is nothing to render: no light with a technique that serves it");
    return jobs;
}

std::vector<ParameterValues> make_grid(const std::string& technique, const Options& options) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(technique);
    std::vector<ParameterValues> grid(1);
    const auto multiply = [&](const ParameterSpec& spec, const std::vector<std::string>& values) {
        std::vector<ParameterValues> larger;
        for (const ParameterValues& point : grid) {
            for (const std::string& value : values) {
                larger.push_back(point);
                larger.back().set(spec.id, parse_value(technique, spec, value));
            }
        }
        grid = std::move(larger);
    };
    if (const ParameterSpec* spec = find_spec(descriptor, "map_size"); spec && !options.map_sizes.empty()) {
        std::vector<std::string> sizes;
        for (const int size : options.map_sizes) sizes.push_back(std::to_string(size));
        multiply(*spec, sizes);
    }
    for (const Setting& setting : options.settings) {
        const ParameterSpec& spec = require_spec(setting);
        if (setting.technique == technique) multiply(spec, setting.values);
    }
    for (const ParameterValues& point : grid) resolve_parameters(descriptor, point);
    return grid;
}

}  // namespace shadow_layers::cli
