// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Where are silhouettes cheapest? The product's finder on the CPU against a compute shader and a geometry shader, on
// closed meshes of growing size (medians of 15 runs; adjacency and uploads are not counted, they are kept between
// frames).
//
//     silhouette_bench [OBJ...]
#include <algorithm>
#include <cstdio>

#include "base/clock.h"
#include "scene/silhouettes.h"
#include "support/technique_runner.h"

using namespace shadow_layers;
using namespace shadow_layers::testing;

namespace {

// A pair edge as both shaders take it: its two vertices and the two apexes.
const char* const kSideFunction = R"(
float side(vec3 a, vec3 b, vec3 c) { return dot(u_light.xyz - u_light.w * a, cross(b - a, c - a)); }
)";

const char* const kCompute = R"(#version 450 core
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Positions { float position[]; };
layout(std430, binding = 1) readonly buffer Edges { uvec4 edges[]; };
layout(std430, binding = 2) writeonly buffer Found { uvec2 found[]; };
layout(std430, binding = 3) buffer Count { uint found_count; };
layout(location = 0) uniform vec4 u_light;
layout(location = 1) uniform int u_count;
vec3 vertex(uint i) { return vec3(position[3*i], position[3*i+1], position[3*i+2]); }
%SIDE%
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(u_count)) return;
    uvec4 e = edges[i];
    vec3 a = vertex(e.x), b = vertex(e.y);
    bool left = side(a, b, vertex(e.z)) > 0.0, right = side(b, a, vertex(e.w)) > 0.0;
    if (left != right) found[atomicAdd(found_count, 1u)] = left ? e.xy : e.yx;
}
)";

const char* const kVertex = R"(#version 450 core
layout(location = 0) in vec3 in_position;
out vec3 place;
void main() { place = in_position; gl_Position = vec4(in_position, 1.0); }
)";

// [Kenzel13] 4.2.1: one triangle with its neighbours, one quad's worth of vertices per silhouette edge of a facing
// triangle.
const char* const kGeometry = R"(#version 450 core
layout(triangles_adjacency) in;
layout(triangle_strip, max_vertices = 12) out;
layout(location = 0) uniform vec4 u_light;
in vec3 place[];
%SIDE%
void main() {
    if (side(place[0], place[2], place[4]) <= 0.0) return;
    for (int k = 0; k < 6; k += 2) {
        int next = (k + 2) % 6;
        if (side(place[next], place[k], place[k + 1]) > 0.0) continue;
        for (int corner = 0; corner < 4; ++corner) {
            gl_Position = vec4((corner < 2 ? place[k] : place[next]) * 1e-6, 1.0);
            EmitVertex();
        }
        EndPrimitive();
    }
}
)";

const char* const kFragment = "#version 450 core\nvoid main() {}\n";

std::string with_side(const char* text) {
    std::string source = text;
    const std::string mark = "%SIDE%";
    source.replace(source.find(mark), mark.size(), kSideFunction);
    return source;
}

double median_ms(const std::function<void()>& work) {
    std::vector<double> times;
    for (int k = 0; k < 16; ++k) {
        const WallClock clock;
        work();
        if (k > 0) times.push_back(clock.elapsed_ms());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

struct Pairs {
    std::vector<glm::uvec4> edges;         ///< a, b, apex whose triangle runs a to b, apex of the other
    std::vector<std::uint32_t> adjacency;  ///< six indices per triangle, GL_TRIANGLES_ADJACENCY
};

Pairs collect_pairs(const Mesh& mesh, const MeshAdjacency& adjacency) {
    Pairs pairs;
    const auto apex_of = [&](const EdgeUse& use, glm::uvec2 edge) {
        const glm::uvec3 t = mesh.triangles[use.triangle()];
        for (int k = 0; k < 3; ++k)
            if (adjacency.weld[t[k]] != edge.x && adjacency.weld[t[k]] != edge.y) return adjacency.weld[t[k]];
        return adjacency.weld[t.x];
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> apex_of_way;
    for (std::uint32_t e = 0; e < adjacency.pair_count; ++e) {
        const glm::uvec2 v = adjacency.edge_vertices[e];
        const auto uses = adjacency.uses_of(e);
        const auto& forward = uses[0].reversed() ? uses[1] : uses[0];
        const auto& backward = uses[0].reversed() ? uses[0] : uses[1];
        pairs.edges.push_back({v.x, v.y, apex_of(forward, v), apex_of(backward, v)});
        apex_of_way[{v.x, v.y}] = pairs.edges.back().z;
        apex_of_way[{v.y, v.x}] = pairs.edges.back().w;
    }
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = adjacency.weld[t[k]], b = adjacency.weld[t[(k + 1) % 3]];
            const auto found = apex_of_way.find({b, a});
            pairs.adjacency.push_back(a);
            pairs.adjacency.push_back(found != apex_of_way.end() ? found->second : adjacency.weld[t[(k + 2) % 3]]);
        }
    return pairs;
}

void bench(Engine& engine, const std::string& name, const MeshData& data) {
    const auto mesh = to_mesh(name, data);
    const MeshEdges edges = engine.mesh_data().get_edges(*mesh, &engine.threads());
    const LightPoint light(1.3, 2.1, 4.7, 1.0);
    std::size_t cpu_found = 0;
    const double two = median_ms(
        [&] { cpu_found = find_silhouettes(*mesh, edges, glm::dmat4(1), light, {}, &engine.threads()).size(); });
    const double one = median_ms([&] { find_silhouettes(*mesh, edges, glm::dmat4(1), light, {}, nullptr); });

    const gl::Device& device = engine.device();
    const GladGLContext& gl = engine.gl();
    const Pairs pairs = collect_pairs(*mesh, *edges.adjacency);
    const gl::Buffer position_buf(device, mesh->positions, "positions");
    const gl::Buffer edge_buf(device, std::span<const glm::uvec4>(pairs.edges), "edges");
    const gl::Buffer found_buf(device, pairs.edges.size() * 8, "found");
    gl::Buffer count_buf(device, 4, "count");
    const gl::Program compute(device, {{GL_COMPUTE_SHADER, with_side(kCompute), {"compute"}}}, "silhouettes");
    compute.use();
    compute.set("u_light", glm::vec4(light));
    compute.set("u_count", int(pairs.edges.size()));
    position_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 0);
    edge_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 1);
    found_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 2);
    count_buf.bind_base(GL_SHADER_STORAGE_BUFFER, 3);
    std::uint32_t compute_found = 0;
    const double by_compute = median_ms([&] {
        count_buf.clear();
        gl.DispatchCompute(GLuint(pairs.edges.size() + 63) / 64, 1, 1);
        gl.MemoryBarrier(GL_ALL_BARRIER_BITS);
        count_buf.read(&compute_found, 4);
    });

    const gl::Buffer index_buf(device, std::span<const std::uint32_t>(pairs.adjacency), "adjacency");
    gl::VertexArray vertices(device, "adjacency");
    vertices.set_float(0, 0, 3, 0);
    vertices.set_buffer(0, position_buf, 12);
    vertices.set_index_buffer(index_buf);
    const gl::Program geometry(device,
                               {{GL_VERTEX_SHADER, kVertex, {"vertex"}},
                                {GL_GEOMETRY_SHADER, with_side(kGeometry), {"geometry"}},
                                {GL_FRAGMENT_SHADER, kFragment, {"fragment"}}},
                               "silhouettes");
    auto depth = std::make_shared<gl::Texture>(device, gl::TextureDesc{GL_DEPTH_COMPONENT32F, 16, 16}, "target");
    gl::Framebuffer target(device, "target");
    target.attach_depth(depth);
    target.bind();
    geometry.use();
    geometry.set("u_light", glm::vec4(light));
    GLuint query = 0;
    gl.GenQueries(1, &query);
    GLuint geometry_primitives = 0;
    const double by_geometry = median_ms([&] {
        apply(gl, DrawState{});
        vertices.bind();
        gl.BeginQuery(GL_PRIMITIVES_GENERATED, query);
        gl.DrawElements(GL_TRIANGLES_ADJACENCY, GLsizei(pairs.adjacency.size()), GL_UNSIGNED_INT, nullptr);
        gl.EndQuery(GL_PRIMITIVES_GENERATED);
        gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &geometry_primitives);
        engine.finish();
    });
    gl.DeleteQueries(1, &query);
    std::printf(
        "%-16s %8zu triangles | CPU 1 thread %7.2f ms, %d threads %7.2f ms (%zu edges) | compute %7.2f ms (%u) | "
        "geometry %7.2f ms (%u)\n",
        name.c_str(), mesh->triangles.size(), one, engine.threads().thread_count(), two, cpu_found, by_compute,
        compute_found, by_geometry, geometry_primitives / 2);
}

}  // namespace

int main(int count, char** words) {
    TechniqueRunner runner;
    for (const int rings : {67, 158, 353}) bench(runner.engine(), "ball", make_sphere(1, rings, 2 * rings));
    for (int k = 1; k < count; ++k)
        if (const auto model = load_obj(words[k]))
            bench(runner.engine(), std::string(words[k]).substr(std::string(words[k]).rfind('/') + 1), *model);
    return 0;
}
