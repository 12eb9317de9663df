// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "frame/receiver_source.h"
#include "shadow_layers/scene.h"
#include "shadow_layers/technique_descriptor.h"
#include "shared/view_choice.h"

namespace shadow_layers {

class ThreadPool;

/// One map's worth of a light sample: a cube face, a spot's cone, a sun's rectangle (later: a cascade).
///
/// Light clip space "_lc": x and y in [-w, w] over the map *including* its border; depth reversed, z / w = 1 on the
/// near plane and 0 on the far plane (GL_ZERO_TO_ONE). So window depth "depth_rz" is larger nearer to the light, planar
/// over a triangle, and precise in float at any near : far ratio. The z row is built from w - near and far - w in
/// double and is not derived from the float w row: a far spot with a tight range keeps its precision.
struct LightView {
    bool perspective = true;
    int size_texels = 0;                 ///< side of the square map, border included
    int border_texels = 0;               ///< on each side, inside size_texels
    double near_ls = 0, far_ls = 0;      ///< along the view's -Z, scene units
    glm::dmat4 ls_from_ws{1.0};          ///< rigid: world to the view's light space (looks along -Z)
    glm::dmat4 lc_from_ls{1.0};          ///< projection as above
    glm::dmat4 lc_from_ws{1.0};          ///< product, for geometry in double
    std::uint8_t face = 0;               ///< cube face 0..5 (+X -X +Y -Y +Z -Z of the light sample's axes)
    std::vector<std::uint32_t> casters;  ///< indices into Scene::instances that can cast into this view's region
    ContentKey key;                      ///< of everything a map drawn from this view depends on
};

/// A point from which the light is cast, with the views that cover its receivers.
struct LightSample {
    bool directional = false;
    glm::dvec3 position_ws{0.0};      ///< unless directional
    glm::dvec3 to_light_ws{0, 0, 1};  ///< unit, towards the light; of a sun. For spot and area: minus their direction
    glm::dmat3 axes_ws{1.0};          ///< columns: x, y, z of the light's cube axes in world space
    double cone_cos = -2;             ///< spot: cos of half the cone; area: 0 (front half-space); else -2 (everything)
    double cone_sin = 0;              ///< sine of the same angle: that of a far, narrow cone is not in its cosine
    glm::dvec2 cone_scale{1.0};       ///< spot: the cone's width along the light's x and y, of the round one's
    std::vector<LightView> views;     ///< only those with receivers; empty: no receiver faces this light
    const Scene* scene = nullptr;  ///< that the views were fitted to, for comparison alone; null: none were asked for
    /// Which of them serves a receiver. All that look up a view ask choose_view (shaders/shared/view_choice.h).
    ViewChoice choice = {glm::ivec4(kOneView, 0, 0, 0), {glm::ivec4(kNoView), glm::ivec4(kNoView)}};

    /// The same light from the same point, whatever its views.
    bool is_same_place(const LightSample& other) const {
        return directional == other.directional && position_ws == other.position_ws &&
               to_light_ws == other.to_light_ws && axes_ws == other.axes_ws && cone_cos == other.cone_cos &&
               cone_scale == other.cone_scale;
    }
};

/// The choice among these views, of one of view_choice.h's kinds.
ViewChoice make_view_choice(int kind, const std::vector<LightView>& views);

/// What the maker of light samples needs to know of the technique.
struct ViewSettings {
    int map_size = 1024;  ///< 0: no views are made
    int border_texels = 0;
    int sample_count = 1;
    LightPattern pattern = LightPattern::Sequence;
};

/// `point`, a sample of the light, with views fitted to the `receivers` that face the light, are in its cone
/// and in its receiver set, and to the casters that can reach them. The views of `previous` (may be null), the same
/// sample made for another sample of the same pixels, are kept where they are of the same scene and still cover the
/// receivers, so that jittered frames share their maps. `threads` (may be null: one thread) does not change the result.
LightSample fit_light_views(const ReceiverSource& receivers, const Light& light, LightSample point,
                            const ViewSettings& settings, const LightSample* previous = nullptr,
                            ThreadPool* threads = nullptr);

/// All samples of a light at once, with their views. `previous`: of another frame, in the same order.
std::vector<LightSample> make_light_samples(const ReceiverSource& receivers, const Light& light,
                                            const ViewSettings& settings,
                                            const std::vector<LightSample>* previous = nullptr,
                                            ThreadPool* threads = nullptr);

}  // namespace shadow_layers
