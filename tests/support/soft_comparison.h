// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Soft layers against rays in double to the same samples of the light, bit by bit as far as a mean tells it.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <vector>

#include "lights/light_shape.h"
#include "support/technique_runner.h"
#include "truth/soft_shadow.h"

namespace shadow_layers::testing {

struct SoftComparison {
    TechniqueRun run;
    std::size_t wrong = 0;  ///< pixels beyond what ties and float weights explain
    std::size_t bits = 0, ties = 0;
    std::size_t lit = 0, penumbra = 0, dark = 0;  ///< pixels that face a sample
};

/// Float sums lose no more; less than one of 1024 samples brings.
inline constexpr double kSoftRounding = 2e-5;

/// Which of several lists of samples a pixel of the frame takes.
using ChooseList = std::function<std::size_t(std::size_t pixel)>;

/// The layer `run` of the view's first light against `lists` of samples.
inline void compare_with_sample_rays(TechniqueRunner& runner, const SceneView& view,
                                     const std::vector<std::vector<LightSample>>& lists, const ChooseList& choose,
                                     SoftComparison& found) {
    const Frame& frame = *found.run.frame;
    const Light& light = view.scene->lights[0];
    const truth::RayOracle oracle(view.scene);
    std::vector<truth::SampleShadows> shadows;
    for (const auto& samples : lists) shadows.emplace_back(oracle, frame, light, samples);
    std::vector<truth::LitPart> parts(frame.pixel_count());
    runner.engine().threads().parallel_for(parts.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel)
            parts[pixel] = shadows[choose(pixel)].find_lit_part(pixel);
    });
    for (std::size_t pixel = 0; pixel < parts.size(); ++pixel) {
        const truth::LitPart& part = parts[pixel];
        const double value = double(found.run.visibility()[pixel]);
        found.wrong += !(value >= part.least - kSoftRounding && value <= part.most + kSoftRounding);
        found.bits += std::size_t(part.bits), found.ties += std::size_t(part.ties);
        if (part.bits > 0) ++(part.decided >= 1 ? found.lit : part.decided <= 0 ? found.dark : found.penumbra);
    }
}

/// `soft` with so many samples of the fixed pattern.
inline SoftComparison compare_soft(TechniqueRunner& runner, SceneView view, const Light& light, int samples) {
    view.scene->lights = {light};
    SoftComparison found;
    found.run = runner.render(view, "soft", parameters({{"light_samples", std::int64_t{samples}}}));
    compare_with_sample_rays(
        runner, view, {sample_light_shape(light, samples, LightPattern::Spiral)},
        [](std::size_t) { return std::size_t{0}; }, found);
    return found;
}

}  // namespace shadow_layers::testing
