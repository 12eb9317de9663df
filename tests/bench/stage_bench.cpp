// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Times of the stages of techniques and their modes, worked in turn so that a busy machine hurts all alike:
//
//     stage_bench [--obj FILE] [--kind spot|sun|point] [--map-size N] [--height PX] [--rounds N] MODE ...
//
// A MODE is "technique" or "technique:parameter=value,...". Each row gives medians over the
// rounds with cold stage caches: wall time of all stages and of the resolve alone, with the latter's ratios to the rows
// before, the greatest difference of its picture to that of the row before, and the processor time of the whole render,
// which other programs on the machine disturb least. The scene is a mesh on a plane, or the tower of the tests.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "support/technique_runner.h"

using namespace shadow_layers;
using namespace shadow_layers::testing;

namespace {

struct Mode {
    std::string name, technique;
    ParameterValues parameters;
    std::vector<float> picture;
    std::vector<double> resolve_ms, all_ms, processor_ms;
    std::map<std::string, double> stages_ms;  // of the last round
};

[[noreturn]] void stop(const std::string& text) {
    std::fprintf(stderr, "stage_bench: %s\n", text.c_str());
    std::exit(2);
}

ParameterValue read_value(const ParameterSpec& spec, const std::string& word) {
    switch (spec.type) {
        case ParameterType::Bool:
            return word == "true" || word == "1" || word == "on";
        case ParameterType::Int:
            return std::int64_t(std::atoll(word.c_str()));
        case ParameterType::Float:
            return std::atof(word.c_str());
        case ParameterType::Enum:
            break;
    }
    return word;
}

Mode read_mode(const std::string& text, std::int64_t map_size) {
    Mode mode;
    mode.name = text;
    mode.technique = text.substr(0, text.find(':'));
    const TechniqueDescriptor& descriptor = find_technique_descriptor(mode.technique);
    mode.parameters.set("map_size", map_size);
    std::istringstream items(text.size() > mode.technique.size() ? text.substr(mode.technique.size() + 1) : "");
    for (std::string item; std::getline(items, item, ',');) {
        const std::string id = item.substr(0, item.find('='));
        const auto spec = std::find_if(descriptor.parameters.begin(), descriptor.parameters.end(),
                                       [&](const ParameterSpec& other) { return other.id == id; });
        if (spec == descriptor.parameters.end()) stop(mode.technique + " has no parameter \"" + id + "\"");
        mode.parameters.set(id, read_value(*spec, item.substr(std::min(item.size(), id.size() + 1))));
    }
    return mode;
}

void time_mode(TechniqueRunner& runner, const SceneView& view, Mode& mode) {
    runner.engine().stages().clear();
    runner.engine().finish();
    const std::clock_t begin = std::clock();
    TechniqueRun run = runner.render(view, mode.technique, mode.parameters);
    const RenderStats& stats = run.stats;
    runner.engine().finish();
    mode.processor_ms.push_back(1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC);
    mode.picture = std::move(run.channels.at("visibility").data);
    double resolve = 0, all = 0;
    mode.stages_ms.clear();
    for (const StageTime& time : stats.times) {
        const double ms = std::max(time.gl_ms, time.cpu_ms);
        mode.stages_ms[time.stage] += ms;
        all += ms;
        if (time.stage == "resolve") resolve += ms;
    }
    mode.resolve_ms.push_back(resolve);
    mode.all_ms.push_back(all);
}

double greatest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double greatest = 0;
    for (std::size_t k = 0; k < a.size(); ++k) greatest = std::max(greatest, double(std::abs(a[k] - b[k])));
    return greatest;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

double median_ratio(const std::vector<double>& values, const std::vector<double>& to) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < values.size(); ++k) ratios.push_back(values[k] / to[k]);
    return median(ratios);
}

void print_rows(const std::vector<Mode>& modes) {
    for (std::size_t row = 0; row < modes.size(); ++row) {
        std::printf(
            "%-48s processor %7.1f ms  all %7.1f ms  resolve %7.1f ms  to the rows before:", modes[row].name.c_str(),
            median(modes[row].processor_ms), median(modes[row].all_ms), median(modes[row].resolve_ms));
        for (std::size_t k = 0; k < row; ++k)
            std::printf(" %.2f", median_ratio(modes[row].resolve_ms, modes[k].resolve_ms));
        if (row > 0) std::printf("  differs by %.2g", greatest_difference(modes[row].picture, modes[row - 1].picture));
        std::printf("\n   ");
        for (const auto& [stage, ms] : modes[row].stages_ms) std::printf(" %s %.1f", stage.c_str(), ms);
        std::printf("\n");
    }
}

}  // namespace

int main(int count, char** words) {
    std::string obj, kind = "spot";
    std::int64_t map_size = 1024;
    int rounds = 9, width = 1280, height = 720;
    std::vector<std::string> texts;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        if (word.rfind("--", 0) != 0) {
            texts.push_back(word);
            continue;
        }
        if (++k >= count) stop("\"" + word + "\" needs a value");
        if (word == "--obj")
            obj = words[k];
        else if (word == "--kind")
            kind = words[k];
        else if (word == "--map-size")
            map_size = std::atoi(words[k]);
        else if (word == "--height")
            height = std::max(1, std::atoi(words[k])), width = height * 16 / 9;
        else if (word == "--rounds")
            rounds = std::max(1, std::atoi(words[k]));
        else
            stop("\"" + word + "\" is not known");
    }
    if (texts.empty()) stop("name at least one technique");
    std::vector<Mode> modes;
    for (const std::string& text : texts) modes.push_back(read_mode(text, map_size));
    const auto mesh = obj.empty() ? std::nullopt : load_obj(obj);
    if (!obj.empty() && !mesh) stop("cannot read " + obj);
    SceneView view = mesh ? model_scene(*mesh, width, height) : tower_scene(width, height);
    const LightKind light_kind = kind == "sun" ? LightKind::Sun : kind == "point" ? LightKind::Point : LightKind::Spot;
    view.scene->lights = {make_light(light_kind, {1.2, 2.6, 4.6}, {0, 0, 0.4}, 60)};

    TechniqueRunner runner;
    for (Mode& mode : modes) runner.render(view, mode.technique, mode.parameters);  // compiles
    for (int round = 0; round < rounds; ++round)
        for (Mode& mode : modes) time_mode(runner, view, mode);
    print_rows(modes);
    return 0;
}
