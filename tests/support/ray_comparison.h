// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A technique against exact rays: pixel by pixel, or by what is wrong.

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
    int different = 0;
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
    const LightPosition& position = result.run.positions.at(0);
    const truth::RayOracle oracle(view.scene);
    result.truth = oracle.compute_visibility(frame, light, position, &runner.engine().threads());
    const FacingRule facing(frame, light, position);
    for (std::size_t pixel = 0; pixel < result.truth.size(); ++pixel) {
        result.different += result.run.visibility()[pixel] != result.truth[pixel];
        if (facing.classify(pixel) == Facing::Lit) ++(result.truth[pixel] > 0.5f ? result.lit : result.shadowed);
    }
    return result;
}

}  // namespace shadow_layers::testing
