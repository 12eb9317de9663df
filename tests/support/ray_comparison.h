// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A technique against exact rays: pixel by pixel, or by what is wrong.

#include <cmath>
#include <string>
#include <vector>

#include "lights/facing.h"
#include "support/shadow_errors.h"
#include "support/technique_runner.h"
#include "truth/ray_oracle.h"

namespace shadow_layers::testing {

inline constexpr LightKind kAllLightKinds[] = {LightKind::Sun, LightKind::Spot, LightKind::Point, LightKind::Area};

struct RayComparison {
    TechniqueRun run;
    std::vector<float> truth;
    int different = 0;          ///< but for ties
    int ties = 0;               ///< pixels that rounding may decide either way
    int lit = 0, shadowed = 0;  ///< by the rays, of the pixels that the casters decide
};

/// Of the technique's layer of the view's first light.
inline ShadowErrors find_shadow_errors(TechniqueRunner& runner, const SceneView& view, const std::string& technique,
                                       const ParameterValues& given = {}) {
    const TechniqueRun run = runner.render(view, technique, given);
    const Light& light = view.scene->lights[0];
    const truth::RayOracle oracle(view.scene);
    const auto truth = oracle.compute_visibility(*run.frame, light, run.positions.at(0), &runner.engine().threads());
    return measure_shadow_errors(*run.frame, light, run.positions[0], truth, run.visibility());
}

/// The technique's layer of `view` under `light` alone.
inline RayComparison compare_with_rays(TechniqueRunner& runner, SceneView view, const Light& light,
                                       const std::string& technique, const ParameterValues& given = {}) {
    view.scene->lights = {light};
    RayComparison result;
    result.run = runner.render(view, technique, given);
    const Frame& frame = *result.run.frame;
    const LightSample& position = result.run.positions.at(0);
    const truth::RayOracle oracle(view.scene);
    const auto truth = oracle.compute_visibility_ranges(frame, light, position, &runner.engine().threads());
    const FacingRule facing(frame, light, position);
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
        result.truth.push_back(truth[pixel].decided);
        const float value = result.run.visibility()[pixel];
        result.different += value != truth[pixel].least && value != truth[pixel].most;
        result.ties += truth[pixel].least != truth[pixel].most;
        if (facing.classify(pixel) == Facing::Undecided) ++(result.truth[pixel] > 0.5f ? result.lit : result.shadowed);
    }
    return result;
}

/// As compare_with_rays, but for the rays' own frame: which triangle a pixel sees is found anew in double, and not
/// taken from the raster. Pixels where both see different surfaces (silhouettes, to a fraction of a pixel) are left
/// out.
inline RayComparison compare_with_eye_rays(TechniqueRunner& runner, SceneView view, const Light& light,
                                           const std::string& technique, const ParameterValues& given = {}) {
    view.scene->lights = {light};
    RayComparison result;
    result.run = runner.render(view, technique, given);
    const Frame& frame = *result.run.frame;
    const truth::RayOracle oracle(view.scene);
    const Frame seen = oracle.make_frame(view.camera, view.width, view.height, &runner.engine().threads());
    const auto truth =
        oracle.compute_visibility_ranges(seen, light, result.run.positions.at(0), &runner.engine().threads());
    const FacingRule facing(seen, light, result.run.positions[0]);
    const double pixel_size = (view.camera.window.right - view.camera.window.left) / view.width;
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
        result.truth.push_back(truth[pixel].decided);
        if (!frame.coverage[pixel] || !seen.coverage[pixel] || facing.classify(pixel) != Facing::Undecided) continue;
        const glm::vec3& place = seen.positions_rel[pixel];
        const float gap = std::abs(glm::dot(frame.positions_rel[pixel] - place, seen.normals[pixel]));
        if (double(gap) > 0.05 * pixel_size * double(glm::length(place))) continue;
        const float value = result.run.visibility()[pixel];
        result.different += value != truth[pixel].least && value != truth[pixel].most;
        result.ties += truth[pixel].least != truth[pixel].most;
        ++(result.truth[pixel] > 0.5f ? result.lit : result.shadowed);
    }
    return result;
}

}  // namespace shadow_layers::testing
