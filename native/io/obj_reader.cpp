// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ (tinyobjloader): geometry only. The whole file is one mesh, because groups cut closed surfaces open.
#include <tiny_obj_loader.h>

#include "io/default_view.h"
#include "io/scene_file.h"
#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

struct Triangles {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

std::shared_ptr<Triangles> collect(const std::string& place, const tinyobj::attrib_t& attributes,
                                   const std::vector<tinyobj::shape_t>& shapes) {
    auto mesh = std::make_shared<Triangles>();
    mesh->positions.reserve(attributes.vertices.size() / 3);
    for (std::size_t i = 0; i + 2 < attributes.vertices.size(); i += 3) {
        mesh->positions.emplace_back(attributes.vertices[i], attributes.vertices[i + 1], attributes.vertices[i + 2]);
    }
    for (const tinyobj::shape_t& shape : shapes) {
        const auto& corners = shape.mesh.indices;
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            glm::uvec3 triangle;
            for (int k = 0; k < 3; ++k) {
                const int index = corners[i + std::size_t(k)].vertex_index;
                if (index < 0 || std::size_t(index) >= mesh->positions.size()) {
                    throw FileError(place + "object '" + shape.name + "': a face uses vertex " +
                                    std::to_string(index + 1) + " of " + std::to_string(mesh->positions.size()));
                }
                triangle[k] = std::uint32_t(index);
            }
            mesh->triangles.push_back(triangle);
        }
    }
    return mesh;
}

}  // namespace

SceneFile read_obj(const std::filesystem::path& path) {
    const std::string place = "'" + path.string() + "': ";
    tinyobj::ObjReaderConfig config;
    config.triangulate = true;
    config.vertex_color = false;
    tinyobj::ObjReader reader;
    // Materials are not used: their absence is no matter.
    if (!reader.ParseFromFile(path.string(), config)) throw FileError(place + "it cannot be read: " + reader.Error());
    const auto mesh = collect(place, reader.GetAttrib(), reader.GetShapes());
    if (mesh->triangles.empty()) throw FileError(place + "it holds no face; is it an OBJ file?");

    SceneFile file;
    file.scene->meshes.push_back(make_mesh(path.stem().string(), mesh->positions, mesh->triangles, mesh));
    file.scene->instances.emplace_back();
    file.source = {{"format", "OBJ"}, {"file", path.filename().string()}};
    add_default_camera(file);
    add_default_light(file);
    return file;
}

}  // namespace shadow_layers::io
