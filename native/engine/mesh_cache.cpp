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

bool is_usable(const Mesh& mesh, const glm::uvec3& t) {
    return is_usable_vertex(mesh.positions[t.x]) && is_usable_vertex(mesh.positions[t.y]) &&
           is_usable_vertex(mesh.positions[t.z]);
}

/// Vertices and indices as GpuMesh describes them.
struct MeshLayout {
    std::vector<std::uint32_t> sources;  ///< mesh vertex of each GPU vertex
    std::vector<glm::uvec3> triangles, numbered_triangles;
    std::uint32_t dropped_count = 0;
};

MeshLayout make_layout(Engine& engine, const Mesh& mesh) {
    constexpr std::uint32_t kNone = 0xffffffffu;
    const std::size_t count = mesh.triangles.size();
    MeshLayout layout;
    layout.sources.reserve(count + count / 4);
    std::vector<std::uint32_t> copies(mesh.positions.size(), kNone);
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t corner = mesh.triangles[k].z;
        layout.sources.push_back(corner);
        if (copies[corner] == kNone) copies[corner] = std::uint32_t(k);
    }
    for (const glm::uvec3& t : mesh.triangles)
        for (const std::uint32_t corner : {t.x, t.y})
            if (copies[corner] == kNone) {
                copies[corner] = std::uint32_t(layout.sources.size());
                layout.sources.push_back(corner);
            }
    layout.triangles.resize(count);
    layout.numbered_triangles.resize(count);
    std::atomic<std::uint32_t> dropped{0};
    engine.threads().parallel_for(count, kBlock, [&](std::size_t begin, std::size_t end) {
        std::uint32_t block_dropped = 0;
        for (std::size_t k = begin; k < end; ++k) {
            const glm::uvec3& t = mesh.triangles[k];
            const bool usable = is_usable(mesh, t);
            block_dropped += !usable;
            const glm::uvec3 nothing = glm::uvec3(std::uint32_t(k));
            layout.triangles[k] = usable ? glm::uvec3(copies[t.x], copies[t.y], copies[t.z]) : nothing;
            layout.numbered_triangles[k] = usable ? glm::uvec3(copies[t.x], copies[t.y], std::uint32_t(k)) : nothing;
        }
        dropped += block_dropped;
    });
    layout.dropped_count = dropped;
    return layout;
}

std::vector<glm::vec3> centre_positions(Engine& engine, const Mesh& mesh, const std::vector<std::uint32_t>& sources,
                                        const glm::dvec3& centre) {
    std::vector<glm::vec3> centred(sources.size());
    engine.threads().parallel_for(centred.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3& position = mesh.positions[sources[i]];
            centred[i] = is_usable_vertex(position) ? glm::vec3(glm::dvec3(position) - centre) : glm::vec3(0.0f);
        }
    });
    return centred;
}

template <class T>
std::shared_ptr<const gl::Buffer> upload(Engine& engine, const std::vector<T>& items, const std::string& label) {
    return std::make_shared<const gl::Buffer>(engine.device(), std::span<const T>(items), label);
}

std::shared_ptr<GpuMesh> upload_mesh(Engine& engine, const Mesh& mesh) {
    auto gpu = std::make_shared<GpuMesh>();
    if (!mesh.bounds.is_empty()) gpu->centre = 0.5 * (mesh.bounds.min + mesh.bounds.max);
    const MeshLayout layout = make_layout(engine, mesh);
    gpu->position_buf =
        upload(engine, centre_positions(engine, mesh, layout.sources, gpu->centre), "positions of " + mesh.name);
    gpu->index_buf = upload(engine, layout.triangles, "triangles of " + mesh.name);
    gpu->numbered_index_buf = upload(engine, layout.numbered_triangles, "numbered triangles of " + mesh.name);
    gpu->triangle_count = std::uint32_t(mesh.triangles.size());
    gpu->dropped_count = layout.dropped_count;
    gpu->vertices = gl::VertexArray(engine.device(), mesh.name);
    gpu->vertices.set_float(kSlotPosition, 0, 3, 0);
    gpu->vertices.set_buffer(0, *gpu->position_buf, sizeof(glm::vec3));
    for (int column = 0; column < 4; ++column)
        gpu->vertices.set_float(GLuint(kSlotClipMatrix + column), 1, 4, sizeof(glm::vec4) * std::size_t(column));
    gpu->vertices.set_uint(kSlotInstance, 1, 1, sizeof(glm::mat4));
    return gpu;
}

/// In every render, not only in the one that sends the mesh: a warning belongs to the picture.
void warn_of_dropped(Engine& engine, const Mesh& mesh, const GpuMesh& gpu) {
    if (gpu.dropped_count == 0) return;
    engine.warn("mesh \"" + mesh.name + "\": " + std::to_string(gpu.dropped_count) + " of " +
                std::to_string(gpu.triangle_count) +
                " triangles are left out, because a vertex is not a finite number or beyond 1e18; check the object's "
                "modifiers");
}

}  // namespace

std::shared_ptr<GpuMesh> MeshCache::get(Engine& engine, const Mesh& mesh) {
    const Key key{mesh.positions_key, mesh.topology_key};
    if (const auto found = index_.find(key); found != index_.end()) {
        entries_.splice(entries_.begin(), entries_, found->second);
        found->second->last_render = render_;
        warn_of_dropped(engine, mesh, *found->second->mesh);
        return found->second->mesh;
    }
    std::shared_ptr<GpuMesh> gpu = upload_mesh(engine, mesh);
    ++upload_count_;
    warn_of_dropped(engine, mesh, *gpu);
    const std::size_t bytes = gpu->byte_size();
    while (!entries_.empty() && bytes_ + bytes > budget_bytes_) drop_last();
    // A mesh over the whole budget is still kept until the next one comes: it is drawn several times a frame.
    entries_.push_front({key, gpu, render_});
    index_[key] = entries_.begin();
    bytes_ += bytes;
    return gpu;
}

void MeshCache::begin_render() {
    ++render_;
    while (!entries_.empty() && entries_.back().last_render + kKeptRenders < render_) drop_last();
}

void MeshCache::drop_last() {
    bytes_ -= entries_.back().mesh->byte_size();
    index_.erase(entries_.back().key);
    entries_.pop_back();
}

void MeshCache::clear() {
    index_.clear();
    entries_.clear();
    bytes_ = 0;
}

}  // namespace shadow_layers
