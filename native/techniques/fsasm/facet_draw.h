// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "engine/engine.h"
#include "techniques/fsasm/facet_contact.h"
#include "techniques/fsasm/facet_pairs.h"
#include "visibility/occlusion_rule.h"

namespace shadow_layers {

/// Draws a view's casters over its pixel-texel pairs and adds what they do to the facets' masks ([Pan09] 3.3, 3.4).
/// A triangle-texel pair is worked when it is found and not kept. Counts "triangle_texel_pairs",
/// "visibility_evaluations", "contacts".
void draw_casters_over_pairs(Engine& engine, const Frame& frame, const LightView& view, PixelTexelPairs& pairs,
                             const facet_kernel::Samples& samples, const FacetContacts& contacts,
                             std::span<SilhouetteFacet> facets);

}  // namespace shadow_layers
