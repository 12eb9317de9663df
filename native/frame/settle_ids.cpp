// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/settle_ids.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "frame/camera_window.h"
#include "scene/vertex_triangles.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kRowsPerBlock = 8;

using Corners = std::array<glm::dvec3, 3>;

bool is_same(const PixelIds& a, const PixelIds& b) { return a.instance == b.instance && a.triangle == b.triangle; }

/// The ray of a pixel's centre, with the moment that makes a line of it.
struct CentreRay {
    glm::dvec3 origin, direction, moment;
    CentreRay(const RayBasis& basis, int column, int row)
        : origin(basis.origin_at(column + 0.5, row + 0.5)),
          direction(basis.direction_at(column + 0.5, row + 0.5)),
          moment(glm::cross(origin, direction)) {}
};

/// A triangle's edges as lines, so that one triangle is asked about several rays at little cost: the volume that ray
/// and edge span is direction . (p x q) + moment . (q - p).
class TriangleEdges {
public:
    explicit TriangleEdges(const Corners& c)
        : moments_{glm::cross(c[1], c[2]), glm::cross(c[2], c[0]), glm::cross(c[0], c[1])},
          ways_{c[2] - c[1], c[0] - c[2], c[1] - c[0]} {}

    /// Whether the ray's line passes by the triangle. Its rim belongs to it; none passes by one that is seen edge-on.
    bool are_passed_by(const CentreRay& ray) const {
        const auto span = [&](int k) { return glm::dot(ray.direction, moments_[k]) + glm::dot(ray.moment, ways_[k]); };
        const double u = span(0), v = span(1), w = span(2);
        return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0) && u + v + w != 0;
    }

private:
    glm::dvec3 moments_[3], ways_[3];
};

/// View depth at which the ray meets the triangle's plane; not a number or infinite if it runs along it.
double find_depth(const CentreRay& ray, const Corners& corners) {
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    return glm::dot(normal, corners[0] - ray.origin) / glm::dot(normal, ray.direction);
}

/// Pixels of a row whose rays pass by their triangles. A row meets a triangle in one piece, so that where the ends of
/// a run are inside, all of it is.
void find_strays(const Frame& frame, const RayBasis& rays, int row, std::vector<std::size_t>& strays) {
    const std::size_t row_begin = std::size_t(row) * std::size_t(frame.width);
    const PixelIds* ids = frame.ids.data() + row_begin;
    for (int begin = 0, end = 0; begin < frame.width; begin = end) {
        while (end < frame.width && is_same(ids[end], ids[begin])) ++end;
        if (ids[begin].instance == kNoId) continue;
        const TriangleEdges edges(frame.get_corners_rel(ids[begin]));
        const auto strays_at = [&](int column) { return edges.are_passed_by(CentreRay(rays, column, row)); };
        int first = begin, last = end;
        for (; first < last && strays_at(first); ++first) strays.push_back(row_begin + std::size_t(first));
        for (; last - 1 > first && strays_at(last - 1); --last) strays.push_back(row_begin + std::size_t(last - 1));
    }
}

std::vector<std::size_t> find_all_strays(ThreadPool& threads, const Frame& frame, const RayBasis& rays) {
    const auto rows = std::size_t(frame.height);
    std::vector<std::vector<std::size_t>> blocks((rows + kRowsPerBlock - 1) / kRowsPerBlock);
    threads.parallel_for(rows, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            find_strays(frame, rays, int(row), blocks[begin / kRowsPerBlock]);
    });
    std::vector<std::size_t> strays;
    for (const auto& block : blocks) strays.insert(strays.end(), block.begin(), block.end());
    return strays;
}

/// Looks for the triangle that a stray pixel's ray meets.
class Settler {
public:
    Settler(Engine& engine, const Frame& frame, const RayBasis& rays) : engine_(engine), frame_(frame), rays_(rays) {}

    PixelIds settle(std::size_t pixel) {
        const int column = int(pixel % std::size_t(frame_.width)), row = int(pixel / std::size_t(frame_.width));
        const PixelIds own = frame_.ids[pixel];
        const CentreRay ray(rays_, column, row);
        Nearest nearest{own};
        const std::uint32_t mesh = frame_.scene->instances[own.instance].mesh;
        const VertexTriangles& around = get_vertex_triangles(mesh);
        const glm::uvec3& vertices = frame_.scene->meshes[mesh]->triangles[own.triangle];
        for (int k = 0; k < 3; ++k)
            for (const std::uint32_t triangle : around.of(vertices[k]))
                consider(ray, {own.instance, triangle}, nearest);
        for (int y = std::max(row - 1, 0); y <= std::min(row + 1, frame_.height - 1); ++y)
            for (int x = std::max(column - 1, 0); x <= std::min(column + 1, frame_.width - 1); ++x)
                consider(ray, frame_.ids[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)], nearest);
        return nearest.ids;
    }

private:
    struct Nearest {
        PixelIds ids;
        double depth = std::numeric_limits<double>::infinity();
    };

    void consider(const CentreRay& ray, const PixelIds& ids, Nearest& nearest) const {
        if (ids.instance == kNoId) return;
        const Corners corners = frame_.get_corners_rel(ids);
        if (TriangleEdges(corners).are_passed_by(ray)) return;
        const double depth = find_depth(ray, corners);
        if (depth >= frame_.camera.clip_start && depth <= frame_.camera.clip_end && depth < nearest.depth)
            nearest = {ids, depth};
    }

    const VertexTriangles& get_vertex_triangles(std::uint32_t index) {
        auto& found = vertex_triangles_[index];
        if (!found) {
            const Mesh& mesh = *frame_.scene->meshes[index];
            found = engine_.mesh_data().get_for_topology<VertexTriangles>(mesh,
                                                                          [&] { return make_vertex_triangles(mesh); });
            engine_.check_cancelled();
        }
        return *found;
    }

    Engine& engine_;
    const Frame& frame_;
    const RayBasis& rays_;
    std::map<std::uint32_t, std::shared_ptr<const VertexTriangles>> vertex_triangles_;
};

}  // namespace

void settle_ids(Engine& engine, Frame& frame) {
    const RayBasis rays(frame.camera, frame.width, frame.height);
    const std::vector<std::size_t> strays = find_all_strays(engine.threads(), frame, rays);
    Settler settler(engine, frame, rays);
    std::vector<PixelIds> settled;
    settled.reserve(strays.size());
    for (const std::size_t pixel : strays) settled.push_back(settler.settle(pixel));
    for (std::size_t i = 0; i < strays.size(); ++i) frame.ids[strays[i]] = settled[i];
}

}  // namespace shadow_layers
