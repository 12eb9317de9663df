// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// What is a pattern of light positions worth? The penumbra of a straight edge under a square and a round area light,
// against its closed form: mean (largest) error in percent of full light, over the penumbra.
//
//     light_pattern_bench
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "support/technique_runner.h"

using namespace shadow_layers;
using namespace shadow_layers::testing;

namespace {

constexpr double kHeight = 8, kEdge = 2, kRadius = 0.4, kCamera = 20;

/// Part of a square or a disc of half width 1 beyond `x`.
double light_beyond(bool round, double x) {
    if (!round) return std::clamp(0.5 - 0.5 * x, 0.0, 1.0);
    const double u = std::clamp(x, -1.0, 1.0);
    return (std::acos(u) - u * std::sqrt(1 - u * u)) / std::numbers::pi;
}

/// A caster over all x < 0, seen from above.
SceneView make_edge(bool round) {
    SceneView view;
    view.width = 240, view.height = 3;
    view.place(view.add("floor", make_plane(60)));
    view.place(view.add("caster", make_plane(60)), placement({-30, 0, kEdge}), kInstanceShadow);
    const double half_penumbra = kRadius * kEdge / (kHeight - kEdge);
    view.camera = make_camera({0, 0, kCamera}, {0, 0, 0}, 240, 3, glm::degrees(2 * std::atan(half_penumbra / kCamera)));
    view.scene->lights = {make_light(LightKind::Area, {0, 0, kHeight}, {0, 0, 0})};
    view.scene->lights[0].area_size = glm::dvec2(2 * kRadius);
    view.scene->lights[0].area_round = round;
    return view;
}

void print_errors(TechniqueRunner& runner, bool round, const char* pattern) {
    const SceneView view = make_edge(round);
    std::printf("| %s | %s |", round ? "disc" : "square", pattern);
    for (const std::int64_t positions : {4, 16, 64, 256}) {
        const auto run = runner.render(view, "multi",
                                       parameters({{"positions", positions},
                                                   {"pattern", std::string(pattern)},
                                                   {"technique", std::string("exact")},
                                                   {"map_size", std::int64_t{512}}}));
        double sum = 0, most = 0;
        for (std::size_t pixel = 0; pixel < run.frame->pixel_count(); ++pixel) {
            const double x = run.frame->positions_rel[pixel].x + run.frame->origin_ws.x;
            const double truth = light_beyond(round, -x * (kHeight - kEdge) / kEdge / kRadius);
            const double error = 100 * std::abs(run.visibility()[pixel] - truth);
            sum += error;
            most = std::max(most, error);
        }
        std::printf(" %.2f (%.2f) |", sum / double(run.frame->pixel_count()), most);
    }
    std::printf("\n");
}

}  // namespace

int main() {
    TechniqueRunner runner;
    std::printf("| light | pattern | N = 4 | 16 | 64 | 256 |\n| --- | --- | --- | --- | --- | --- |\n");
    for (const bool round : {false, true})
        for (const char* pattern : {"spiral", "sequence", "grid", "random"}) print_errors(runner, round, pattern);
    return 0;
}
