// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy and time of techniques and their modes against exact rays, as a table:
//
//     technique_bench [--scenes box,tower,random] [--models DIR] [--map-size N] [--lights N] [--kind spot|sun|point]
//                     [--rounds N] [--all] [--techniques pcf,edsm]
//
// "wrong" is the mean over the lights; "ratio" is to sm's. "plane" counts the ground alone. Times are medians of
// `rounds` renders with cold stage caches, frame included; their ratio is taken pair by pair, so that a busy machine
// hurts less.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "base/clock.h"
#include "support/ray_oracle.h"
#include "support/shadow_errors.h"
#include "support/technique_runner.h"

using namespace shadow_layers;
using namespace shadow_layers::testing;

namespace {

struct Options {
    std::string scenes = "box,tower,random", models, kind = "spot";
    std::string techniques = "pcf,edsm,smsr,smsr2,rsmss";  ///< beside sm, with their defaults
    std::int64_t map_size = 1024;
    int lights = 3, rounds = 0;
    bool all = false;
};

struct Variant {
    std::string name, technique;
    ParameterValues parameters;
};

[[noreturn]] void stop(const std::string& text) {
    std::fprintf(stderr, "technique_bench: %s\n", text.c_str());
    std::exit(2);
}

Options read_options(int count, char** words) {
    Options options;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        if (word == "--all") {
            options.all = true;
            continue;
        }
        if (k + 1 >= count) stop("\"" + word + "\" needs a value or is not known");
        const std::string value = words[++k];
        if (word == "--scenes")
            options.scenes = value;
        else if (word == "--models")
            options.models = value;
        else if (word == "--kind")
            options.kind = value;
        else if (word == "--techniques")
            options.techniques = value;
        else if (word == "--map-size")
            options.map_size = std::atoi(value.c_str());
        else if (word == "--lights")
            options.lights = std::max(1, std::atoi(value.c_str()));
        else if (word == "--rounds")
            options.rounds = std::atoi(value.c_str());
        else
            stop("\"" + word + "\" is not known");
    }
    return options;
}

std::vector<std::pair<std::string, SceneView>> make_scenes(const Options& options) {
    std::vector<std::pair<std::string, SceneView>> scenes;
    const auto wanted = [&](const char* name) { return options.scenes.find(name) != std::string::npos; };
    if (wanted("box")) scenes.emplace_back("box", box_scene());
    if (wanted("tower")) scenes.emplace_back("tower", tower_scene());
    if (wanted("random")) scenes.emplace_back("random", random_scene(4, 1280, 720));
    if (options.models.empty()) return scenes;
    for (const char* name : {"scorpion", "bunny_hr", "armadillo", "teapot"})
        if (auto model = load_obj(options.models + "/" + name + ".obj")) scenes.emplace_back(name, model_scene(*model));
    return scenes;
}

std::vector<Variant> make_variants(const Options& options) {
    const auto mode = [](const char* id, const char* value) { return parameters({{id, std::string(value)}}); };
    std::vector<Variant> variants = {{"sm", "sm", {}}};
    std::istringstream ids(options.techniques);
    for (std::string id; std::getline(ids, id, ',');) variants.push_back({id, find_technique_descriptor(id).id, {}});
    if (options.all) {
        variants.push_back({"smsr, reduced", "smsr", mode("mode", "reduced")});
        variants.push_back({"smsr, half", "smsr", mode("mode", "half")});
        variants.push_back({"smsr, one depth", "smsr", parameters({{"epsilon_rule", false}})});
        variants.push_back({"rsmss, disjoint", "rsmss", mode("channels", "disjoint")});
        variants.push_back({"edsm, stream", "edsm", mode("edge_order", "stream")});
        variants.push_back({"edsm, min", "edsm", mode("edge_order", "min")});
        variants.push_back({"edsm, thesis order", "edsm", mode("edge_order", "thesis")});
        variants.push_back({"edsm, perspective", "edsm", mode("quads", "perspective")});
        ParameterValues thesis = mode("edge_order", "thesis");
        thesis.set("reading", std::string("thesis"));
        variants.push_back({"edsm, thesis", "edsm", thesis});
    }
    for (Variant& variant : variants) variant.parameters.set("map_size", options.map_size);
    return variants;
}

std::vector<Light> make_lights(const Options& options) {
    const LightKind kind = options.kind == "sun"     ? LightKind::Sun
                           : options.kind == "point" ? LightKind::Point
                                                     : LightKind::Spot;
    std::mt19937 random(9);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Light> lights;
    for (int k = 0; k < options.lights; ++k) {
        const double x = unit(random), y = unit(random), z = unit(random);
        lights.push_back(make_light(kind, glm::dvec3(1.2, 2.6, 4.6) + 0.7 * glm::dvec3(x, y, z), {0, 0, 0.4}, 60));
    }
    return lights;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

struct Row {
    ShadowErrors errors;
    std::map<std::string, std::int64_t> counters;
    std::vector<double> times_ms, time_ratios;
};

void measure_errors(TechniqueRunner& runner, const Options& options, SceneView& view,
                    const std::vector<Variant>& variants, std::vector<Row>& rows) {
    for (const Light& light : make_lights(options)) {
        view.scene->lights = {light};
        std::vector<float> truth;
        const RayOracle oracle(view.scene);
        for (std::size_t v = 0; v < variants.size(); ++v) {
            const auto run = runner.render(view, variants[v].technique, variants[v].parameters);
            if (truth.empty())
                truth = oracle.compute_visibility(*run.frame, light, run.positions[0], &runner.engine().threads());
            const auto errors = measure_shadow_errors(*run.frame, light, run.positions[0], truth, run.visibility());
            rows[v].errors.wrong_ppm += errors.wrong_ppm / options.lights;
            rows[v].errors.plane_wrong_ppm += errors.plane_wrong_ppm / options.lights;
            rows[v].errors.acne_ppm += errors.acne_ppm / options.lights;
            rows[v].errors.leak_ppm += errors.leak_ppm / options.lights;
            rows[v].counters = run.stats.counters;
        }
    }
}

void measure_times(TechniqueRunner& runner, int rounds, const SceneView& view, const std::vector<Variant>& variants,
                   std::vector<Row>& rows) {
    for (int round = 0; round < rounds; ++round)
        for (std::size_t v = 0; v < variants.size(); ++v) {
            runner.engine().stages().clear();
            runner.engine().finish();
            const WallClock clock;
            runner.render(view, variants[v].technique, variants[v].parameters);
            rows[v].times_ms.push_back(clock.elapsed_ms());
            rows[v].time_ratios.push_back(rows[v].times_ms.back() / rows[0].times_ms.back());
        }
}

void print_rows(const std::string& scene, const std::vector<Variant>& variants, std::vector<Row>& rows) {
    const ShadowErrors& sm = rows[0].errors;
    for (std::size_t v = 0; v < variants.size(); ++v) {
        const ShadowErrors& errors = rows[v].errors;
        std::printf("%-10s %-20s %8.0f ppm  ratio %.3f  plane %8.0f (%.3f)  acne %5.0f  leak %5.0f", scene.c_str(),
                    variants[v].name.c_str(), errors.wrong_ppm, errors.wrong_ppm / sm.wrong_ppm, errors.plane_wrong_ppm,
                    errors.plane_wrong_ppm / sm.plane_wrong_ppm, errors.acne_ppm, errors.leak_ppm);
        if (!rows[v].times_ms.empty())
            std::printf("  %6.1f ms  ratio %.2f", median(rows[v].times_ms), median(rows[v].time_ratios));
        for (const char* counter : {"triangles", "silhouette_edges", "edge_quads", "edge_fragments"})
            if (rows[v].counters.contains(counter))
                std::printf("  %s %lld", counter, static_cast<long long>(rows[v].counters[counter]));
        std::printf("\n");
        std::fflush(stdout);
    }
}

}  // namespace

int main(int count, char** words) {
    const Options options = read_options(count, words);
    const std::vector<Variant> variants = make_variants(options);
    TechniqueRunner runner;
    for (auto& [name, view] : make_scenes(options)) {
        std::vector<Row> rows(variants.size());
        measure_errors(runner, options, view, variants, rows);
        measure_times(runner, options.rounds, view, variants, rows);
        print_rows(name, variants, rows);
    }
    return 0;
}
