// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures do not change with what must not matter: the scale and the place of the whole scene, a light that goes to
// infinity, the field of view. Every registered technique goes through it, with its default parameters but for maps
// that are cheaper to draw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "gl/shared_session.h"
#include "lights/facing.h"
#include "shadow_layers/session.h"
#include "support/ray_oracle.h"
#include "support/technique_scenes.h"

namespace shadow_layers::testing {
namespace {

constexpr int kWidth = 480, kHeight = 270;
constexpr std::int64_t kMapSize = 512;
/// Part of the pixels that may differ.
constexpr double kAllowed = 0.001;
/// A pixel that moved by less than this is the same.
constexpr float kSame = 1.0f / 255;

/// Techniques that rebuild a penumbra from the border of a hard shadow carry one of its pixels, rounded the other way,
/// over the whole width of the penumbra.
float find_same(const std::string& technique) {
    const TechniqueDescriptor& descriptor = find_technique_descriptor(technique);
    const bool is_soft = find_truth(descriptor, resolve_parameters(descriptor, {})).kind == TruthKind::Soft;
    return is_soft ? 6 * kSame : kSame;
}

/// `map_size` 0: the technique's default.
std::vector<float> render(const SceneView& view, const std::string& technique, std::int64_t map_size = 0,
                          const ParameterValues& given = {}) {
    RenderRequest request;
    request.scene = view.scene;
    request.camera = view.camera;
    request.width = view.width, request.height = view.height;
    request.combined = false;
    ParameterValues values = given;
    for (const ParameterSpec& spec : find_technique_descriptor(technique).parameters)
        if (spec.id == "map_size" && map_size > 0) values.set("map_size", map_size);
    request.jobs.push_back({0, technique, values});
    std::vector<float> visibility;
    shared_session().render(request, [&](Layer&& layer) { visibility = layer.channels.at("visibility").data; });
    return visibility;
}

double count_differing(const std::vector<float>& a, const std::vector<float>& b, float same = kSame) {
    EXPECT_EQ(a.size(), b.size());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) differing += !(std::abs(a[i] - b[i]) <= same);
    return double(differing) / double(a.size());
}

/// The scene with its camera and its lights, scaled about the origin and then moved.
SceneView transform_view(const SceneView& view, double scale, const glm::dvec3& offset) {
    SceneView moved = view;
    moved.scene = std::make_shared<Scene>(*view.scene);
    const glm::dmat4 matrix = glm::scale(glm::translate(glm::dmat4(1), offset), glm::dvec3(scale));
    for (Instance& instance : moved.scene->instances) instance.world_from_object = matrix * instance.world_from_object;
    for (Light& light : moved.scene->lights) {
        light.world_from_light[3] = matrix * light.world_from_light[3];
        light.radius *= scale;
        light.area_size *= scale;
    }
    moved.camera.world_from_camera[3] = matrix * view.camera.world_from_camera[3];
    moved.camera.clip_start *= scale, moved.camera.clip_end *= scale;
    return moved;
}

struct Case {
    std::string technique;
    LightKind kind;
    bool is_wide = false;  ///< a light of a size that shows; otherwise suns, spots and points have none
};

std::string name_of(const Case& item) {
    return item.technique + "_" + std::array{"sun", "spot", "point", "area"}[std::size_t(item.kind)] +
           (item.is_wide ? "_wide" : "");
}
std::ostream& operator<<(std::ostream& stream, const Case& item) { return stream << name_of(item); }

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const TechniqueDescriptor& technique : technique_descriptors())
        for (const LightKind kind : technique.lights) {
            cases.push_back({technique.id, kind});
            if (technique.light_size == LightSize::Followed) cases.push_back({technique.id, kind, true});
        }
    return cases;
}

class Invariance : public ::testing::TestWithParam<Case> {
protected:
    const std::string& technique() const { return GetParam().technique; }
    SceneView lit(SceneView view) const {
        Light light = make_light(GetParam().kind, {2.1, -0.7, 3.9}, {0.1, 0.2, 0.4}, 80);
        if (GetParam().is_wide) light.radius = 0.4, light.sun_angle = 0.15, light.area_size = {0.9, 0.6};
        view.scene->lights = {light};
        return view;
    }
    std::vector<SceneView> views() const {
        return {lit(random_scene(3, kWidth, kHeight)), lit(tower_scene(kWidth, kHeight))};
    }
    /// The picture must hold enough of both for a difference to show.
    static void expect_worth_comparing(const std::vector<float>& visibility) {
        const auto lit_count = std::count_if(visibility.begin(), visibility.end(), [](float v) { return v > 0.5f; });
        EXPECT_GT(double(lit_count), 0.04 * double(visibility.size()));
        EXPECT_GT(double(visibility.size()) - double(lit_count), 0.04 * double(visibility.size()));
    }
};
INSTANTIATE_TEST_SUITE_P(AllTechniques, Invariance, ::testing::ValuesIn(all_cases()),
                         [](const auto& named) { return name_of(named.param); });

// One test for all: the picture that the others are held against is rendered once.
TEST_P(Invariance, ScaleAndPlaceOfTheScene) {
    const auto expect_same = [&](const std::vector<float>& plain, const SceneView& view, double scale,
                                 const glm::dvec3& offset) {
        const std::vector<float> moved = render(transform_view(view, scale, offset), technique(), kMapSize);
        EXPECT_LE(count_differing(plain, moved, find_same(technique())), kAllowed)
            << "scale " << scale << ", moved by " << offset.x << ", " << offset.y << ", " << offset.z;
    };
    bool is_first = true;
    for (const SceneView& view : views()) {
        const std::vector<float> plain = render(view, technique(), kMapSize);
        expect_worth_comparing(plain);
        for (const double scale : {1e-4, 0.37, 1e6}) expect_same(plain, view, scale, glm::dvec3(0));
        for (const glm::dvec3 offset : {glm::dvec3(1e6, 0, 0), glm::dvec3(-1e6, 1e6, 1e6), glm::dvec3(0.3, -0.1, 0.2)})
            expect_same(plain, view, 1, offset);
        if (!std::exchange(is_first, false)) continue;
        expect_same(plain, view, 1e6, {1e12, -1e12, 0});
        expect_same(plain, view, 1e-4, {100, -100, 100});
        EXPECT_EQ(plain, render(view, technique(), kMapSize)) << "rendered twice";
    }
}

class InvarianceOfTechnique : public ::testing::TestWithParam<std::string> {
protected:
    bool serves(LightKind kind) const {
        const auto& kinds = find_technique_descriptor(GetParam()).lights;
        return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
    }
};

std::vector<std::string> all_techniques() {
    std::vector<std::string> ids;
    for (const TechniqueDescriptor& technique : technique_descriptors()) ids.push_back(technique.id);
    return ids;
}
INSTANTIATE_TEST_SUITE_P(AllTechniques, InvarianceOfTechnique, ::testing::ValuesIn(all_techniques()),
                         [](const auto& named) { return named.param; });

TEST_P(InvarianceOfTechnique, AFarSpotIsASun) {
    if (!serves(LightKind::Sun) || !serves(LightKind::Spot)) GTEST_SKIP() << "serves no suns or no spots";
    constexpr double kSceneSize = 6;  // what the picture shows of it
    for (SceneView view : {box_scene(kWidth, kHeight), random_scene(3, kWidth, kHeight)}) {
        const glm::dvec3 towards = glm::normalize(glm::dvec3(0.5, -0.3, 1.2));
        const Light sun = make_light(LightKind::Sun, towards, {0, 0, 0});
        std::map<std::int64_t, std::vector<float>> by_sun;  // by map size
        for (const double times : {1e3, 1e4, 1e5, 1e6}) {
            const double distance = times * kSceneSize;
            // Nearer than 1e5 the rays really do diverge, by up to a texel and a tenth of a pixel. So the maps are fine
            // enough to show the shadow and not their texels, and only pixels that change sides count.
            const bool is_near = times < 1e5;
            // At 1e5 they still diverge by 1/200 texel, which a ramp one texel wide shows.
            const float same = is_near ? 0.5f : times < 1e6 ? 3 * kSame : kSame;
            const std::int64_t map_size = is_near ? 4096 : kMapSize;
            view.scene->lights = {sun};
            if (!by_sun.contains(map_size)) by_sun[map_size] = render(view, GetParam(), map_size);
            view.scene->lights = {
                make_light(LightKind::Spot, towards * distance, {0, 0, 0}, glm::degrees(40 / distance))};
            const std::vector<float> by_spot = render(view, GetParam(), map_size);
            EXPECT_LE(count_differing(by_sun[map_size], by_spot, same), kAllowed)
                << "distance " << times << " times the scene";
        }
    }
}

/// Does an axis-aligned box lie between a point and the light? Closed form by slabs.
bool is_behind_box(const glm::dvec3& point, const glm::dvec3& light, const glm::dvec3& low, const glm::dvec3& high) {
    const glm::dvec3 way = light - point;
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (low[axis] - point[axis]) / way[axis], b = (high[axis] - point[axis]) / way[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave;
}

glm::dvec3 point_of(const Frame& frame, std::size_t pixel) {
    return frame.origin_ws + glm::dvec3(frame.positions_rel[pixel]);
}

/// Are all pixels within `reach` of the same kind?
bool is_plain_round(const std::vector<std::uint8_t>& kinds, const Frame& frame, std::size_t pixel, int reach) {
    const int px = int(pixel) % frame.width, py = int(pixel) / frame.width;
    for (int y = std::max(0, py - reach); y <= std::min(frame.height - 1, py + reach); ++y)
        for (int x = std::max(0, px - reach); x <= std::min(frame.width - 1, px + reach); ++x)
            if (kinds[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)] != kinds[pixel]) return false;
    return true;
}

/// The world length of a texel at a point on the floor.
double texel_at(const std::vector<LightSample>& positions, const glm::dvec3& point) {
    double texel = 0;
    for (const LightSample& position : positions)
        for (const LightView& view : position.views) {
            const glm::dvec4 clip = view.lc_from_ws * glm::dvec4(point, 1);
            if (!(clip.w > 0) || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) continue;
            for (int axis = 0; axis < 2; ++axis) {
                const glm::dvec3 step(axis == 0, axis == 1, 0);
                const glm::dvec4 moved = view.lc_from_ws * glm::dvec4(point + 1e-6 * step, 1);
                const double texels =
                    glm::length(glm::dvec2(moved) / moved.w - glm::dvec2(clip) / clip.w) * 0.5 * view.size_texels;
                texel = std::max(texel, 1e-6 / texels);
            }
        }
    return texel;
}

// A box floats over a floor; its shadow has a closed form. Pixels nearer to the outline than the technique's texels and
// its filter reach are not counted.
TEST_P(InvarianceOfTechnique, FieldOfViewAgainstAClosedForm) {
    const TechniqueDescriptor& technique = find_technique_descriptor(GetParam());
    // The lights have no size, so that nothing beyond the picture's rim has a say.
    ParameterValues given;
    for (const ParameterSpec& spec : technique.parameters)
        if (spec.id == "overscan") given.set("overscan", std::int64_t(spec.min));
    const TechniqueNeeds needs = technique.needs(resolve_parameters(technique, given));
    const glm::dvec3 low(-0.8, -0.6, 0.5), high(0.7, 0.9, 1.4), place(2.3, -1.1, 4.7);
    for (const LightKind kind : {LightKind::Point, LightKind::Spot}) {
        if (!serves(kind)) continue;
        for (const double fov_deg : {0.5, 2.0, 20.0, 60.0, 120.0, 160.0, 170.0}) {
            SceneView view;
            view.width = 320, view.height = 180;
            view.place(view.add("floor", make_plane(60)));
            view.place(view.add("box", make_box(glm::vec3(high - low))),
                       glm::translate(glm::dmat4(1), 0.5 * (low + high)), kInstanceShadow);
            // At a corner of the shadow, so that the narrowest view shows its outline.
            const glm::dvec3 edge(low.x + 1e-9, high.y - 1e-9, high.z),
                corner = place + (edge - place) * (place.z / (place.z - edge.z));
            view.camera = make_camera({3.1, -4.2, 5.3}, corner, view.width, view.height, fov_deg);
            view.camera.clip_start = 0.001;
            view.scene->lights = {make_light(kind, place, {0, 0, 0}, 100)};
            const std::vector<float> visibility = render(view, technique.id, 0, given);

            const Frame frame = RayOracle(view.scene).make_frame(view.camera, view.width, view.height);
            ViewSettings settings;
            // Without maps there are no texels to keep clear of: those taken for them are finer than pixels.
            settings.map_size = needs.map_size > 0 ? needs.map_size : 1 << 14;
            settings.border_texels = needs.map_border_texels;
            const auto positions = make_light_samples(frame, view.scene->lights[0], settings);
            const FacingRule rule(frame, view.scene->lights[0], positions[0]);
            std::vector<std::uint8_t> dark(frame.pixel_count());
            for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel)
                dark[pixel] = rule.classify(pixel) != Facing::Undecided
                                  ? 2
                                  : is_behind_box(point_of(frame, pixel), place, low, high);
            int counted = 0, wrong = 0, shaded = 0;
            for (std::size_t pixel = 0; pixel < frame.pixel_count(); ++pixel) {
                if (dark[pixel] == 2) continue;
                const glm::dvec3 point = point_of(frame, pixel);
                const double reach = (2.5 + needs.map_border_texels) * texel_at(positions, point);
                bool clear = is_plain_round(dark, frame, pixel, needs.overscan_px);
                for (int k = 0; k < 8 && clear; ++k) {
                    const glm::dvec3 step(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4), 0);
                    clear = is_behind_box(point + reach * step, place, low, high) == bool(dark[pixel]);
                }
                if (!clear) continue;
                ++counted;
                shaded += dark[pixel];
                wrong += std::abs(visibility[pixel] - (dark[pixel] ? 0.0f : 1.0f)) > kSame;
            }
            const std::string where = technique.id + ", fov " + std::to_string(fov_deg);
            EXPECT_LE(wrong, kAllowed * counted)
                << where << ": " << wrong << " of " << counted << " (" << shaded << " in shadow)";
            // At 160 degrees and more the shadow is a few pixels, nearly all of them at its outline.
            EXPECT_GT(counted, fov_deg < 150 ? 5000 : 100) << where;
            EXPECT_TRUE(shaded > 100 || fov_deg > 150) << where;
        }
    }
}

}  // namespace
}  // namespace shadow_layers::testing
