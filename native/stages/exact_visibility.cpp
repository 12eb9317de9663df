// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/exact_visibility.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "lights/facing.h"
#include "scene/bounds.h"
#include "stages/occlusion_rule.h"
#include "stages/receiver_tiles.h"
#include "stages/tile_kernel.h"

namespace shadow_layers {
namespace {

using tile_kernel::CasterTriangle;
using tile_kernel::LinearForm;

// Triangles are set up and drawn in chunks, so that memory stays bounded.
constexpr std::size_t kChunk = 1 << 16;
constexpr std::size_t kSetupBlock = 1 << 10;
constexpr int kBandCount = 16;
constexpr std::size_t kOpenPairs = 1 << 12;
// Of sums of a few products in double, each term taken by its magnitude.
constexpr double kDoubleError = 1e-15;

/// Casters of a view as one row of numbered triangles.
class CasterList {
public:
    CasterList(const Scene& scene, const LightView& view) : scene_(scene), view_(view) {
        std::size_t total = 0;
        for (const std::uint32_t instance : view.casters) {
            first_.push_back(total);
            total += scene.meshes[scene.instances[instance].mesh]->triangles.size();
        }
        first_.push_back(total);
    }
    std::size_t size() const { return first_.back(); }

    /// Calls body(instance, triangle, clip matrix) for the numbers [begin, end).
    template <class Body>
    void for_each(std::size_t begin, std::size_t end, const Body& body) const {
        std::size_t at = std::size_t(std::upper_bound(first_.begin(), first_.end(), begin) - first_.begin()) - 1;
        while (begin < end) {
            const std::size_t stop = std::min(end, first_[at + 1]);
            const std::uint32_t index = view_.casters[at];
            const Instance& instance = scene_.instances[index];
            const glm::dmat4 lc_from_object = view_.lc_from_ws * instance.world_from_object;
            const Mesh& mesh = *scene_.meshes[instance.mesh];
            for (; begin < stop; ++begin) body(index, std::uint32_t(begin - first_[at]), mesh, lc_from_object);
            ++at;
        }
    }

private:
    const Scene& scene_;
    const LightView& view_;
    std::vector<std::size_t> first_;
};

/// Clip coordinates as the edge functions take them: (x, y, w), and the depth's z apart.
struct ClipCorner {
    glm::dvec3 xyw;
    double z;
};

double sum_abs(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Tiles that an interval of clip units may touch.
void set_tile_range(double low, double high, int side, int& begin, int& end) {
    begin = std::clamp(int(std::floor(std::max((low + 1) * 0.5 * side, 0.0))), 0, side);
    end = std::clamp(int(std::floor(std::min((high + 1) * 0.5 * side, double(side)))) + 1, 0, side);
}

/// Tiles and greatest depth; false if no tile is touched. A triangle that reaches behind the light may touch all.
bool set_extent(const ClipCorner (&corners)[3], int side, double margin, CasterTriangle& t) {
    t.column_begin = t.row_begin = 0;
    t.column_end = t.row_end = side;
    t.greatest_depth = std::numeric_limits<double>::infinity();
    const double near_w = std::min({corners[0].xyw.z, corners[1].xyw.z, corners[2].xyw.z});
    const double far_w = std::max({corners[0].xyw.z, corners[1].xyw.z, corners[2].xyw.z});
    if (!(far_w > 0)) return false;
    // Outside one plane of the pyramid: also right for corners behind the light.
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            bool outside = true;
            for (const ClipCorner& c : corners)
                outside = outside && sign * c.xyw[axis] > c.xyw.z + margin * std::abs(c.xyw.z);
            if (outside) return false;
        }
    if (!(near_w > 1e-9 * far_w)) return true;
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    t.greatest_depth = -std::numeric_limits<double>::infinity();
    for (const ClipCorner& c : corners) {
        const glm::dvec2 place = glm::dvec2(c.xyw) / c.xyw.z;
        low = glm::min(low, place);
        high = glm::max(high, place);
        t.greatest_depth = std::max(t.greatest_depth, c.z / c.xyw.z);
    }
    set_tile_range(low.x - margin, high.x + margin, side, t.column_begin, t.column_end);
    set_tile_range(low.y - margin, high.y + margin, side, t.row_begin, t.row_end);
    return t.column_begin < t.column_end && t.row_begin < t.row_end;
}

/// Edge functions and depth of a triangle over the view. With q = (x, y, 1) and corners a, b, c as (x, y, w):
/// det q = (q . b x c) a + (q . c x a) b + (q . a x b) c. So the light's ray through q meets the triangle iff the three
/// factors have the sign of det = a . b x c, and z / w there is their mean of the corners' z. Nothing is divided by w,
/// so corners behind the light need no clipping. False if the light sees the triangle edge-on.
bool set_forms(const ClipCorner (&corners)[3], CasterTriangle& t) {
    const glm::dvec3 &a = corners[0].xyw, &b = corners[1].xyw, &c = corners[2].xyw;
    const glm::dvec3 normals[3] = {glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)};
    const double det = glm::dot(a, normals[0]);
    if (!(std::abs(det) > 0) || !std::isfinite(det)) return false;
    const double sign = det > 0 ? 1 : -1, size = std::abs(det);
    const double error[3] = {sum_abs(b) * sum_abs(c), sum_abs(c) * sum_abs(a), sum_abs(a) * sum_abs(b)};
    t.depth = {0, 0, 0};
    t.depth_error = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 n = sign * normals[i];
        t.edges[i] = {n.z, n.x, n.y};
        t.edge_error[i] = 8 * kDoubleError * error[i];
        const double z = corners[i].z / size;
        t.depth.at_origin += n.z * z;
        t.depth.by_x += n.x * z;
        t.depth.by_y += n.y * z;
        t.depth_error += 8 * kDoubleError * error[i] * std::abs(z);
    }
    return true;
}

class ViewDraw {
public:
    ViewDraw(Engine& engine, const Frame& frame, const LightView& view, const OcclusionRule& rule, ReceiverTiles tiles,
             std::vector<std::uint8_t>& visible)
        : engine_(engine),
          frame_(frame),
          rule_(rule),
          sorted_(std::move(tiles)),
          visible_(visible),
          casters_(*frame.scene, view) {}

    void draw() {
        const std::size_t total = casters_.size();
        triangles_.resize(std::min(kChunk, total));
        for (std::size_t begin = 0; begin < total; begin += kChunk) {
            engine_.check_cancelled();
            const std::size_t count = std::min(kChunk, total - begin);
            set_up(begin, count);
            draw_bands(count);
        }
        engine_.count("caster_triangles", std::int64_t(total));
        engine_.count("tile_tests", std::int64_t(tests_));
        engine_.count("open_pairs", std::int64_t(open_pairs_));
    }

private:
    void set_up(std::size_t begin, std::size_t count) {
        // Places are bounded to this much; a tile's own bound is used where it counts.
        const double margin = 1e-9 + double(sorted_.largest_place_error);
        engine_.threads().parallel_for(count, kSetupBlock, [&](std::size_t from, std::size_t to) {
            std::size_t slot = from;
            casters_.for_each(begin + from, begin + to,
                              [&](std::uint32_t instance, std::uint32_t triangle, const Mesh& mesh,
                                  const glm::dmat4& lc_from_object) {
                                  CasterTriangle& t = triangles_[slot++];
                                  t.instance = instance;
                                  t.triangle = triangle;
                                  if (!set_triangle(mesh, lc_from_object, margin, t)) t.row_end = t.row_begin = 0;
                              });
        });
    }

    bool set_triangle(const Mesh& mesh, const glm::dmat4& lc_from_object, double margin, CasterTriangle& t) const {
        ClipCorner corners[3];
        for (int k = 0; k < 3; ++k) {
            const glm::vec3& position = mesh.positions[mesh.triangles[t.triangle][k]];
            if (!is_usable_vertex(position)) return false;
            const glm::dvec4 lc = lc_from_object * glm::dvec4(position, 1.0);
            corners[k] = {{lc.x, lc.y, lc.w}, lc.z};
        }
        return set_extent(corners, sorted_.side, margin, t) && has_receivers(t) && set_forms(corners, t);
    }

    /// Small triangles over empty tiles end here.
    bool has_receivers(const CasterTriangle& t) const {
        if ((t.column_end - t.column_begin) * (t.row_end - t.row_begin) > 16) return true;
        for (int row = t.row_begin; row < t.row_end; ++row)
            for (int column = t.column_begin; column < t.column_end; ++column)
                if (sorted_.count[std::size_t(row) * std::size_t(sorted_.side) + std::size_t(column)] > 0) return true;
        return false;
    }

    void draw_bands(std::size_t count) {
        const int rows = (sorted_.side + kBandCount - 1) / kBandCount;
        const std::size_t bands = std::size_t((sorted_.side + rows - 1) / rows);
        engine_.threads().parallel_for(bands, 1, [&](std::size_t band, std::size_t) {
            draw_band(count, int(band) * rows, std::min(int(band + 1) * rows, sorted_.side));
        });
    }

    void draw_band(std::size_t count, int row_begin, int row_end) {
        std::vector<std::uint32_t> order;
        for (std::size_t i = 0; i < count; ++i)
            if (triangles_[i].row_begin < row_end && triangles_[i].row_end > row_begin)
                order.push_back(std::uint32_t(i));
        std::vector<tile_kernel::OpenPair> open(kOpenPairs);
        tile_kernel::Tiles tiles{sorted_.side,
                                 sorted_.half_size,
                                 sorted_.first.data(),
                                 sorted_.count.data(),
                                 sorted_.least_depth.data(),
                                 sorted_.place_error.data(),
                                 sorted_.depth_error.data(),
                                 sorted_.x.data(),
                                 sorted_.y.data(),
                                 sorted_.depth.data(),
                                 sorted_.pixel.data()};
        static_assert(sizeof(PixelIds) == 2 * sizeof(std::uint32_t));
        tile_kernel::Answers answers{
            visible_.data(), &frame_.ids.data()->instance, open.data(), 0, open.size(), &ViewDraw::settle, this, 0};
        draw_triangles_(triangles_.data(), order.data(), order.size(), row_begin, row_end, tiles, answers);
        settle(this, answers);
        tests_ += answers.tests;
    }

    static void settle(void* context, tile_kernel::Answers& answers) {
        auto& self = *static_cast<ViewDraw*>(context);
        self.open_pairs_ += answers.open_count;
        for (std::size_t i = 0; i < answers.open_count; ++i) {
            const tile_kernel::OpenPair& pair = answers.open[i];
            if (!self.visible_[pair.pixel]) continue;
            const glm::dvec3 receiver = self.rule_.find_receiver(pair.pixel);
            if (self.rule_.is_blocked(receiver, self.frame_.ids[pair.pixel], {pair.instance, pair.triangle}))
                self.visible_[pair.pixel] = 0;
        }
        answers.open_count = 0;
    }

    Engine& engine_;
    const Frame& frame_;
    const OcclusionRule& rule_;
    ReceiverTiles sorted_;
    std::vector<std::uint8_t>& visible_;
    CasterList casters_;
    std::vector<CasterTriangle> triangles_;
    const tile_kernel::DrawTriangles draw_triangles_ = tile_kernel::choose_draw_triangles();
    std::atomic<std::uint64_t> tests_{0}, open_pairs_{0};
};

}  // namespace

std::vector<std::uint8_t> compute_exact_visibility(Engine& engine, const Frame& frame, const Light& light,
                                                   const LightPosition& position, int most_tiles) {
    SortedReceivers sorted;
    {
        const auto timer = engine.time_stage("receiver_tiles");
        sorted = sort_receivers(frame, light, position, most_tiles, engine.threads());
    }
    const auto timer = engine.time_stage("caster_tiles");
    const OcclusionRule rule(frame, position);
    for (std::size_t view = 0; view < position.views.size(); ++view) {
        engine.count("receivers", std::int64_t(sorted.views[view].receiver_count));
        ViewDraw(engine, frame, position.views[view], rule, std::move(sorted.views[view]), sorted.visible).draw();
    }
    return std::move(sorted.visible);
}

}  // namespace shadow_layers
