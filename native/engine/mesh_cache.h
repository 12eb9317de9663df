// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>

#include "gl/buffer.h"
#include "gl/vertex_array.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

class Engine;

/// A mesh on the GPU. Vertex k, for k below the triangle count, is a copy of the last corner of triangle k, which is
/// the one that flat outputs come from: gl_VertexID tells a fragment its triangle so. (gl_PrimitiveID would, too, but
/// costs a software driver a third of its time.) Vertices that are no triangle's last corner follow. A triangle that
/// uses a vertex that is not finite is kept with no area, so that the others keep their numbers.
struct GpuMesh {
    std::shared_ptr<const gl::Buffer> position_buf;        ///< float x, y, z about `centre`, tightly packed
    std::shared_ptr<const gl::Buffer> index_buf;           ///< three uint32 per triangle, shared vertices: the fewest
    std::shared_ptr<const gl::Buffer> numbered_index_buf;  ///< the same triangles, each ending in its own vertex
    gl::VertexArray vertices;
    glm::dvec3 centre{0.0};  ///< object space; exact in double
    std::uint32_t triangle_count = 0;
    std::uint32_t dropped_count = 0;  ///< triangles without area for a vertex that is not finite
    std::size_t byte_size() const {
        return position_buf->byte_size() + index_buf->byte_size() + numbered_index_buf->byte_size();
    }
};

/// Uploaded meshes by content, least recently used out first when over budget; those that kKeptRenders renders
/// (base/content_cache.h) did not draw go, too. What stays the same between frames is not sent again; a mesh that
/// deforms is sent whole.
class MeshCache {
public:
    explicit MeshCache(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

    /// Stays valid while the pointer is held, also when pushed out. Warns of dropped triangles, once per render.
    std::shared_ptr<GpuMesh> get(Engine& engine, const Mesh& mesh);
    /// Marks the start of a render; lets go of what the last ones did not draw.
    void begin_render();
    void clear();
    std::size_t bytes() const { return bytes_; }
    std::size_t upload_count() const { return upload_count_; }  ///< for tests

private:
    using Key = std::pair<ContentKey, ContentKey>;
    struct Entry {
        Key key;
        std::shared_ptr<GpuMesh> mesh;
        std::uint64_t last_render;
    };
    void drop_last();

    std::list<Entry> entries_;  ///< most recently used first
    std::map<Key, std::list<Entry>::iterator> index_;
    std::size_t budget_bytes_, bytes_ = 0, upload_count_ = 0;
    std::uint64_t render_ = 0;
};

}  // namespace shadow_layers
