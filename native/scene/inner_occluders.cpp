// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/inner_occluders.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "scene/bounds.h"

namespace shadow_layers {
namespace {

// Coarser meshes have triangles as large as what could stand for them.
constexpr std::size_t kFewTriangles = 256;
constexpr int kLeastCells = 12, kMostCells = 64;
constexpr std::size_t kMostBoxes = 96;
// Cells from the middle of a box to its nearest side, at least: smaller boxes hide too little.
constexpr int kLeastReach = 2;
constexpr int kMostRegions = 16;

std::uint64_t mix(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    return bits ^ (bits >> 31);
}

std::uint64_t hash_place(const glm::vec3& p) {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (int k = 0; k < 3; ++k) hash = mix(hash ^ std::bit_cast<std::uint32_t>(p[k] + 0.0f));  // -0 becomes 0
    return hash;
}

/// Does every edge belong to an even number of usable triangles? By a sum of hashes modulo 2, which is 0 by chance once
/// in 2^64.
bool is_closed(const Mesh& mesh, const std::vector<std::uint32_t>& usable) {
    std::vector<std::uint64_t> places(mesh.positions.size());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = hash_place(mesh.positions[i]);
    std::uint64_t sum = 0;
    for (const std::uint32_t i : usable) {
        const glm::uvec3& triangle = mesh.triangles[i];
        for (int k = 0; k < 3; ++k) {
            const std::uint64_t p = places[triangle[k]], q = places[triangle[(k + 1) % 3]];
            if (p != q) sum ^= mix(mix(p + q) + (p ^ q));
        }
    }
    return sum == 0;
}

enum Cell : std::uint8_t { kUnknown, kSurface, kOutside, kInside };

class Grid {
public:
    Grid(const Mesh& mesh, const std::vector<std::uint32_t>& usable) : mesh_(mesh), usable_(usable) {
        const glm::dvec3 extent = mesh.bounds.max - mesh.bounds.min;
        const double longest = std::max({extent.x, extent.y, extent.z});
        const int along = std::clamp(int(2.5 * std::cbrt(double(usable.size()))), kLeastCells, kMostCells);
        size_ = longest / along;
        for (int k = 0; k < 3; ++k) count_[k] = std::min(int(extent[k] / size_) + 1, along) + 2;
        low_ = mesh.bounds.min - size_;
        cells_.assign(std::size_t(count_[0]) * std::size_t(count_[1]) * std::size_t(count_[2]), kUnknown);
    }
    bool is_useful() const { return size_ > 0 && std::isfinite(size_); }

    void find_inside() {
        for (const std::uint32_t i : usable_) mark_surface(i);
        fill({0, 0, 0}, kOutside);  // the grid's rim is empty
        int regions = 0;
        for_cells([&](const glm::ivec3& cell) {
            if (at(cell) != kUnknown) return;
            // All of a region that no triangle touches has one parity.
            const bool is_odd = regions++ < kMostRegions && has_odd_parity(middle_of(cell));
            fill(cell, is_odd ? kInside : kOutside);
        });
    }

    /// Boxes of inside cells, the largest first; they may overlap.
    std::vector<Bounds> find_boxes() {
        std::vector<std::uint8_t> reach = compute_reach();
        std::vector<Bounds> boxes;
        while (boxes.size() < kMostBoxes) {
            const std::size_t best = std::size_t(std::max_element(reach.begin(), reach.end()) - reach.begin());
            if (reach[best] < kLeastReach) break;
            const glm::ivec3 middle = cell_of(best);
            glm::ivec3 low = middle - (int(reach[best]) - 1), high = middle + (int(reach[best]) - 1);
            grow(low, high);
            for (int z = low.z; z <= high.z; ++z)
                for (int y = low.y; y <= high.y; ++y)
                    for (int x = low.x; x <= high.x; ++x) reach[index({x, y, z})] = 0;
            // A little smaller than its cells, whose bounds are rounded.
            boxes.push_back({low_ + size_ * (glm::dvec3(low) + 1e-3), low_ + size_ * (glm::dvec3(high) + 1.0 - 1e-3)});
        }
        return boxes;
    }

private:
    std::size_t index(const glm::ivec3& c) const {
        return (std::size_t(c.z) * std::size_t(count_[1]) + std::size_t(c.y)) * std::size_t(count_[0]) +
               std::size_t(c.x);
    }
    std::uint8_t& at(const glm::ivec3& c) { return cells_[index(c)]; }
    glm::ivec3 cell_of(std::size_t i) const {
        const auto x = std::size_t(count_[0]), y = std::size_t(count_[1]);
        return {int(i % x), int(i / x % y), int(i / x / y)};
    }
    glm::dvec3 middle_of(const glm::ivec3& c) const { return low_ + size_ * (glm::dvec3(c) + 0.5); }
    bool holds(const glm::ivec3& c) const {
        return glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, count_));
    }
    template <class Body>
    void for_cells(const Body& body) {
        for (std::size_t i = 0; i < cells_.size(); ++i) body(cell_of(i));
    }

    std::array<glm::dvec3, 3> get_corners(std::uint32_t triangle) const {
        const glm::uvec3& t = mesh_.triangles[triangle];
        return {glm::dvec3(mesh_.positions[t.x]), glm::dvec3(mesh_.positions[t.y]), glm::dvec3(mesh_.positions[t.z])};
    }

    /// All cells that the triangle may touch: by its box and its plane.
    void mark_surface(std::uint32_t triangle) {
        const auto [a, b, c] = get_corners(triangle);
        const double slack = 1e-6 * size_ + 1e-7 * glm::length(low_);
        const glm::ivec3 from = glm::ivec3((glm::min(glm::min(a, b), c) - slack - low_) / size_);
        const glm::ivec3 to = glm::ivec3((glm::max(glm::max(a, b), c) + slack - low_) / size_);
        const glm::dvec3 normal = glm::cross(b - a, c - a), steep = glm::abs(normal);
        const double reach = 0.5 * size_ * (steep.x + steep.y + steep.z) + slack * glm::length(normal);
        for (int z = from.z; z <= to.z; ++z)
            for (int y = from.y; y <= to.y; ++y)
                for (int x = from.x; x <= to.x; ++x) {
                    const glm::ivec3 cell(x, y, z);
                    if (holds(cell) && std::abs(glm::dot(normal, middle_of(cell) - a)) <= reach) at(cell) = kSurface;
                }
    }

    void fill(const glm::ivec3& seed, Cell with) {
        std::vector<glm::ivec3> open = {seed};
        at(seed) = with;
        while (!open.empty()) {
            const glm::ivec3 cell = open.back();
            open.pop_back();
            for (int k = 0; k < 3; ++k)
                for (const int step : {-1, 1}) {
                    glm::ivec3 next = cell;
                    next[k] += step;
                    if (!holds(next) || at(next) != kUnknown) continue;
                    at(next) = with;
                    open.push_back(next);
                }
        }
    }

    /// Triangles between the point and infinity, in a direction along which nothing is modelled.
    bool has_odd_parity(const glm::dvec3& point) const {
        const glm::dvec3 direction(0.61803, 0.41421, 0.66818);
        bool odd = false;
        for (const std::uint32_t i : usable_) {
            auto [a, b, c] = get_corners(i);
            a -= point, b -= point, c -= point;
            const double u = glm::dot(direction, glm::cross(b, c)), v = glm::dot(direction, glm::cross(c, a)),
                         w = glm::dot(direction, glm::cross(a, b));
            if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) continue;
            const double volume = glm::dot(a, glm::cross(b, c));
            if (u + v + w != 0 && (volume > 0) == (u + v + w > 0)) odd = !odd;
        }
        return odd;
    }

    /// Per cell: 1 + the cells to the nearest one that is not inside, by the larger of their ways along the axes; 0
    /// outside.
    std::vector<std::uint8_t> compute_reach() {
        std::vector<std::uint8_t> reach(cells_.size());
        for (std::size_t i = 0; i < cells_.size(); ++i) reach[i] = cells_[i] == kInside ? 255 : 0;
        // One axis after the other: the least of (distance, value) is a square's of both.
        for (int pass = 1; pass <= kMostCells / 2; ++pass) {
            std::vector<std::uint8_t> next = reach;
            bool changed = false;
            for (std::size_t i = 0; i < reach.size(); ++i) {
                if (reach[i] != 255) continue;
                const glm::ivec3 cell = cell_of(i);
                for (int n = 0; n < 27; ++n) {
                    const glm::ivec3 near = cell + glm::ivec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
                    if (holds(near) && reach[index(near)] == 255) continue;
                    next[i] = std::uint8_t(pass);
                    changed = true;
                    break;
                }
            }
            reach.swap(next);
            if (!changed) break;
        }
        return reach;
    }

    /// Moves the box's sides outwards as long as all cells beyond are inside.
    void grow(glm::ivec3& low, glm::ivec3& high) {
        for (bool grows = true; grows;) {
            grows = false;
            for (int k = 0; k < 3; ++k)
                for (const bool up : {false, true}) {
                    glm::ivec3 from = low, to = high;
                    from[k] = to[k] = up ? high[k] + 1 : low[k] - 1;
                    if (!all_inside(from, to)) continue;
                    (up ? high : low)[k] = from[k];
                    grows = true;
                }
        }
    }
    bool all_inside(const glm::ivec3& from, const glm::ivec3& to) {
        for (int z = from.z; z <= to.z; ++z)
            for (int y = from.y; y <= to.y; ++y)
                for (int x = from.x; x <= to.x; ++x)
                    if (!holds({x, y, z}) || at({x, y, z}) != kInside) return false;
        return true;
    }

    const Mesh& mesh_;
    const std::vector<std::uint32_t>& usable_;
    double size_ = 0;
    glm::ivec3 count_{0};
    glm::dvec3 low_{0.0};
    std::vector<std::uint8_t> cells_;
};

struct Triangles {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;

    void add_rectangle(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
        const auto first = std::uint32_t(positions.size());
        for (const glm::dvec3& p : {corner, corner + u, corner + u + v, corner + v}) positions.emplace_back(p);
        triangles.emplace_back(first, first + 1, first + 2);
        triangles.emplace_back(first, first + 2, first + 3);
    }
};

}  // namespace

std::shared_ptr<const InnerOccluders> make_inner_occluders(const Mesh& mesh, ThreadPool* threads) {
    auto occluders = std::make_shared<InnerOccluders>();
    std::vector<std::uint32_t> usable;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        if (is_usable_vertex(mesh.positions[t.x]) && is_usable_vertex(mesh.positions[t.y]) &&
            is_usable_vertex(mesh.positions[t.z]))
            usable.push_back(i);
    }
    if (usable.size() < kFewTriangles || !is_closed(mesh, usable)) return occluders;
    Grid grid(mesh, usable);
    if (!grid.is_useful()) return occluders;
    grid.find_inside();
    const auto data = std::make_shared<Triangles>();
    for (const Bounds& box : grid.find_boxes()) {
        const glm::dvec3 size = box.max - box.min, middle = 0.5 * (box.min + box.max);
        for (int k = 0; k < 3; ++k) {
            glm::dvec3 corner = box.min, u(0.0), v(0.0);
            corner[k] = middle[k];
            u[(k + 1) % 3] = size[(k + 1) % 3];
            v[(k + 2) % 3] = size[(k + 2) % 3];
            data->add_rectangle(corner, u, v);
        }
    }
    if (data->triangles.empty()) return occluders;
    occluders->mesh = make_mesh(mesh.name + " (inside)", data->positions, data->triangles, data);
    occluders->tree = make_mesh_tree(*occluders->mesh, threads);
    return occluders;
}

}  // namespace shadow_layers
