// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The facts of edsm's wrong pixels: its maps as they were drawn, the geometry in double, and rays.

#include <cstddef>
#include <memory>

#include "support/edsm_causes.h"
#include "support/technique_runner.h"
#include "truth/ray_oracle.h"

namespace shadow_layers::testing {

/// Looks at the pixels of one light's layer. The arguments must outlive it.
class EDSMExaminer {
public:
    /// `run`: of edsm with `parameters`, just rendered by `runner`, whose maps are then still in the stage cache. Only
    /// hard shadows by the reading "improved" can be replayed; others throw std::invalid_argument.
    EDSMExaminer(TechniqueRunner& runner, const TechniqueRun& run, const ParameterValues& parameters,
                 const Light& light, const truth::RayOracle& oracle);
    ~EDSMExaminer();

    /// Of a pixel that the casters decide. `lit`: the truth.
    FootprintFacts find_facts(std::size_t pixel, bool lit) const;
    /// What the technique says of such a pixel, done anew in double: whether the facts are the technique's.
    bool replay(std::size_t pixel) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Wrong pixels by cause; they add up to `wrong`.
struct EDSMCauses {
    std::size_t compared = 0, wrong = 0, not_replayed = 0;  ///< wrong pixels that the replay has right
    std::array<std::size_t, kEDSMCauseCount> by_cause{};

    std::size_t count(EDSMCause cause) const { return by_cause[std::size_t(cause)]; }
    EDSMCauses& operator+=(const EDSMCauses& other);
};

/// Of edsm's layer of light number `light`, over the pixels that the casters decide.
EDSMCauses count_edsm_causes(TechniqueRunner& runner, const SceneView& view, const truth::RayOracle& oracle,
                             const ParameterValues& parameters, std::size_t light = 0);

}  // namespace shadow_layers::testing
