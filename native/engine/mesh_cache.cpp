// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mesh_cache.h"

#include <atomic>

#include "engine/engine.h"
#include "engine/scene_draw.h"
#include "scene/bounds.h"
#include "scene_slots.h"

namespace shadow_layers {
namespace {

constexpr std::size_t kBlock = 1 << 16;

std::shared_ptr<const gl::Buffer> upload_positions(Engine& engine, const Mesh& mesh, const glm::dvec3& centre) {
    std::vector<glm::vec3> centred(mesh.positions.size());
    engine.threads().parallel_for(centred.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            centred[i] = is_usable_vertex(mesh.positions[i]) ? glm::vec3(glm::dvec3(mesh.positions[i]) - centre)
                                                             : glm::vec3(0.0f);
    });
    return std::make_shared<const gl::Buffer>(engine.device(), std::span<const glm::vec3>(centred),
                                              "positions of " + mesh.name);
}

/// Triangles with an unusable vertex become three times vertex 0: no area, so no fragment, and the others keep their
/// numbers.
std::shared_ptr<const gl::Buffer> upload_triangles(Engine& engine, const Mesh& mesh, std::uint32_t& dropped_count) {
    std::atomic<std::uint32_t> dropped{0};
    std::vector<glm::uvec3> filtered;
    const auto is_usable = [&](const glm::uvec3& t) {
        return is_usable_vertex(mesh.positions[t.x]) && is_usable_vertex(mesh.positions[t.y]) &&
               is_usable_vertex(mesh.positions[t.z]);
    };
    engine.threads().parallel_for(mesh.triangles.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        std::uint32_t count = 0;
        for (std::size_t i = begin; i < end; ++i) count += !is_usable(mesh.triangles[i]);
        dropped += count;
    });
    std::span<const glm::uvec3> triangles = mesh.triangles;
    dropped_count = dropped;
    if (dropped_count > 0) {
        filtered.assign(triangles.begin(), triangles.end());
        for (glm::uvec3& t : filtered)
            if (!is_usable(t)) t = glm::uvec3(0);
        triangles = filtered;
        engine.warn("mesh \"" + mesh.name + "\": " + std::to_string(dropped_count) + " of " +
                    std::to_string(triangles.size()) +
                    " triangles are left out, because a vertex is not a finite number; check the object's modifiers");
    }
    return std::make_shared<const gl::Buffer>(engine.device(), triangles, "triangles of " + mesh.name);
}

std::shared_ptr<GpuMesh> upload_mesh(Engine& engine, const Mesh& mesh) {
    auto gpu = std::make_shared<GpuMesh>();
    if (!mesh.bounds.is_empty()) gpu->centre = 0.5 * (mesh.bounds.min + mesh.bounds.max);
    gpu->position_buf = upload_positions(engine, mesh, gpu->centre);
    gpu->index_buf = upload_triangles(engine, mesh, gpu->dropped_count);
    gpu->triangle_count = std::uint32_t(mesh.triangles.size());
    gpu->vertices = gl::VertexArray(engine.device(), mesh.name);
    gpu->vertices.set_float(kSlotPosition, 0, 3, 0);
    gpu->vertices.set_buffer(0, *gpu->position_buf, sizeof(glm::vec3));
    gpu->vertices.set_index_buffer(*gpu->index_buf);
    for (int column = 0; column < 4; ++column)
        gpu->vertices.set_float(GLuint(kSlotClipMatrix + column), 1, 4, sizeof(glm::vec4) * std::size_t(column));
    gpu->vertices.set_uint(kSlotInstance, 1, 1, sizeof(glm::mat4));
    return gpu;
}

}  // namespace

std::shared_ptr<GpuMesh> MeshCache::get(Engine& engine, const Mesh& mesh) {
    const Key key{mesh.positions_key, mesh.topology_key};
    if (const auto found = index_.find(key); found != index_.end()) {
        entries_.splice(entries_.begin(), entries_, found->second);
        return found->second->mesh;
    }
    std::shared_ptr<GpuMesh> gpu = upload_mesh(engine, mesh);
    ++upload_count_;
    const std::size_t bytes = gpu->byte_size();
    while (!entries_.empty() && bytes_ + bytes > budget_bytes_) {
        bytes_ -= entries_.back().mesh->byte_size();
        index_.erase(entries_.back().key);
        entries_.pop_back();
    }
    // A mesh over the whole budget is still kept until the next one comes: it is drawn several times a frame.
    entries_.push_front({key, gpu});
    index_[key] = entries_.begin();
    bytes_ += bytes;
    return gpu;
}

void MeshCache::clear() {
    index_.clear();
    entries_.clear();
    bytes_ = 0;
}

}  // namespace shadow_layers
