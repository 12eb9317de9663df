// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// glTF 2.0 (tinygltf): triangles, nodes, cameras and KHR_lights_punctual. +Y stays up. Materials are not used.
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <set>

#include "io/default_view.h"
#include "io/gltf_accessor.h"
#include "io/scene_file.h"
#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

using std::numbers::pi;

// Luminous efficacy used to turn photometric units into watts: 683 lm/W, the definition of the candela at 555 nm, as
// Blender's own importer does. It scales the clay picture only.
constexpr double kLumensPerWatt = 683.0;
constexpr int kMaxDepth = 256;

const std::set<std::string> kKnownExtensions = {"KHR_lights_punctual", "KHR_mesh_quantization",
                                                "KHR_texture_transform"};

struct MeshData {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
};

// Reads one file. Nodes are visited once each: glTF's node graph is a forest.
class GltfReader {
public:
    GltfReader(const std::filesystem::path& path, const ReadOptions& options)
        : path_(path), place_("'" + path.string() + "': "), options_(options) {}

    SceneFile read() {
        load();
        check_extensions();
        mesh_of_.assign(model_.meshes.size(), kNotRead);
        visited_.assign(model_.nodes.size(), false);
        if (model_.scenes.empty()) fail("it has no scene");
        const int scene_index = model_.defaultScene >= 0 ? model_.defaultScene : 0;
        if (std::size_t(scene_index) >= model_.scenes.size())
            fail("scene " + std::to_string(scene_index) + " does not exist");
        for (const int node : model_.scenes[std::size_t(scene_index)].nodes) visit(node, glm::dmat4(1.0), 0);
        finish();
        return std::move(file_);
    }

private:
    static constexpr int kNotRead = -2, kNothing = -1;

    [[noreturn]] void fail(const std::string& what) const { throw FileError(place_ + what); }

    void warn(const std::string& text) {
        if (std::find(file_.warnings.begin(), file_.warnings.end(), text) == file_.warnings.end()) {
            file_.warnings.push_back(text);
        }
    }

    void load() {
        tinygltf::TinyGLTF loader;
        // Pictures are not wanted, and their decoder need not meet hostile data.
        loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                                 const unsigned char*, int, void*) { return true; },
                              nullptr);
        std::string error, warning;
        const bool binary = path_.extension() == ".glb" || path_.extension() == ".GLB";
        const bool ok = binary ? loader.LoadBinaryFromFile(&model_, &error, &warning, path_.string())
                               : loader.LoadASCIIFromFile(&model_, &error, &warning, path_.string());
        if (!ok) fail("it cannot be read as glTF 2.0: " + (error.empty() ? std::string("unknown reason") : error));
        if (!model_.asset.version.starts_with("2")) fail("its version '" + model_.asset.version + "' is not 2.x");
    }

    void check_extensions() const {
        for (const std::string& name : model_.extensionsRequired) {
            if (!kKnownExtensions.contains(name) && !name.starts_with("KHR_materials_") &&
                !name.starts_with("KHR_texture_")) {
                fail("it requires the extension " + name + ", which is not read here; export it without");
            }
        }
    }

    std::string node_name(int index) const {
        const std::string& name = model_.nodes[std::size_t(index)].name;
        return name.empty() ? "node " + std::to_string(index) : name;
    }

    glm::dmat4 local_matrix(int index) const {
        const tinygltf::Node& node = model_.nodes[std::size_t(index)];
        const auto check = [&](const std::vector<double>& values, std::size_t count, const char* what) {
            if (!values.empty() && values.size() != count)
                fail("node '" + node_name(index) + "': " + what + " is not of " + std::to_string(count) + " numbers");
            return !values.empty();
        };
        glm::dmat4 matrix(1.0);
        if (check(node.matrix, 16, "matrix")) {
            for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[std::size_t(i)];
            return matrix;
        }
        if (check(node.translation, 3, "translation")) {
            matrix[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1);
        }
        if (check(node.rotation, 4, "rotation")) {
            const auto& r = node.rotation;
            const glm::dquat rotation(r[3], r[0], r[1], r[2]);
            if (!(glm::length(rotation) > 0)) fail("node '" + node_name(index) + "': rotation of length 0");
            matrix *= glm::mat4_cast(glm::normalize(rotation));
        }
        if (check(node.scale, 3, "scale")) {
            for (int i = 0; i < 3; ++i) matrix[i] *= node.scale[std::size_t(i)];
        }
        return matrix;
    }

    void visit(int index, const glm::dmat4& world_from_parent, int depth) {
        if (index < 0 || std::size_t(index) >= model_.nodes.size())
            fail("node " + std::to_string(index) + " does not exist");
        if (visited_[std::size_t(index)]) fail("node '" + node_name(index) + "' is in the scene twice, or in a circle");
        if (depth > kMaxDepth) fail("its nodes are nested more than " + std::to_string(kMaxDepth) + " deep");
        visited_[std::size_t(index)] = true;
        const tinygltf::Node& node = model_.nodes[std::size_t(index)];
        const glm::dmat4 world_from_node = world_from_parent * local_matrix(index);
        if (node.mesh >= 0) add_instance(node, world_from_node);
        if (node.camera >= 0) add_camera(index, world_from_node);
        add_light(index, world_from_node);
        for (const char* name : {"EXT_mesh_gpu_instancing"}) {
            if (node.extensions.contains(name))
                warn(std::string("the extension ") + name + " is not read: one instance was made");
        }
        for (const int child : node.children) visit(child, world_from_node, depth + 1);
    }

    void add_instance(const tinygltf::Node& node, const glm::dmat4& world_from_node) {
        if (std::size_t(node.mesh) >= model_.meshes.size())
            fail("mesh " + std::to_string(node.mesh) + " does not exist");
        if (node.skin >= 0) warn("skins are not read: skinned meshes stand in their bind pose");
        int& mesh = mesh_of_[std::size_t(node.mesh)];
        if (mesh == kNotRead) mesh = read_mesh(model_.meshes[std::size_t(node.mesh)], node.mesh);
        if (mesh == kNothing) return;
        Instance instance;
        instance.mesh = std::uint32_t(mesh);
        instance.world_from_object = world_from_node;
        file_.scene->instances.push_back(instance);
    }

    // All primitives of a glTF mesh become one mesh: they are cut by material, often through closed surfaces.
    int read_mesh(const tinygltf::Mesh& mesh, int index) {
        const std::string name = mesh.name.empty() ? "mesh " + std::to_string(index) : mesh.name;
        auto data = std::make_shared<MeshData>();
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
            append_primitive(mesh.primitives[p], place_ + "mesh '" + name + "' primitive " + std::to_string(p) + ": ",
                             *data);
        }
        if (data->triangles.empty()) return kNothing;
        file_.scene->meshes.push_back(make_mesh(name, data->positions, data->triangles, data));
        return int(file_.scene->meshes.size()) - 1;
    }

    void append_primitive(const tinygltf::Primitive& primitive, const std::string& place, MeshData& data) {
        const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        if (mode < TINYGLTF_MODE_TRIANGLES) {
            warn("points and lines were left out");
            return;
        }
        if (mode > TINYGLTF_MODE_TRIANGLE_FAN) throw FileError(place + "mode " + std::to_string(mode) + " is unknown");
        if (!primitive.targets.empty()) warn("morph targets are not read: meshes stand in their base shape");
        const auto attribute = primitive.attributes.find("POSITION");
        if (attribute == primitive.attributes.end()) {
            warn("primitives without POSITION were left out");
            return;
        }
        const auto positions = read_vec3_accessor(model_, attribute->second, place + "POSITION: ");
        std::vector<std::uint32_t> corners;
        if (primitive.indices >= 0) {
            corners = read_index_accessor(model_, primitive.indices, place + "indices: ");
        } else {
            corners.resize(positions.size());
            for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = std::uint32_t(i);
        }
        for (const std::uint32_t corner : corners) {
            if (corner >= positions.size()) {
                throw FileError(place + "index " + std::to_string(corner) + " is beyond its " +
                                std::to_string(positions.size()) + " vertices");
            }
        }
        const auto base = std::uint32_t(data.positions.size());
        data.positions.insert(data.positions.end(), positions.begin(), positions.end());
        append_triangles(mode, corners, base, data.triangles);
    }

    static void append_triangles(int mode, const std::vector<std::uint32_t>& corners, std::uint32_t base,
                                 std::vector<glm::uvec3>& triangles) {
        const glm::uvec3 offset(base);
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
                triangles.push_back(glm::uvec3(corners[i], corners[i + 1], corners[i + 2]) + offset);
            }
            return;
        }
        for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
            glm::uvec3 triangle(corners[i], corners[i + 1], corners[i + 2]);
            if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                triangle.x = corners[0];
            else if (i % 2 == 1)
                std::swap(triangle.y, triangle.z);  // every other triangle of a strip is turned
            // Strips are sewn together with triangles that have a corner twice.
            if (triangle.x != triangle.y && triangle.y != triangle.z && triangle.z != triangle.x)
                triangles.push_back(triangle + offset);
        }
    }

    void add_camera(int index, glm::dmat4 world_from_camera) {
        const tinygltf::Node& node = model_.nodes[std::size_t(index)];
        if (std::size_t(node.camera) >= model_.cameras.size())
            fail("camera " + std::to_string(node.camera) + " does not exist");
        const tinygltf::Camera& source = model_.cameras[std::size_t(node.camera)];
        camera_names_.push_back(node_name(index));
        const bool wanted = options_.camera.empty()
                                ? !has_camera_
                                : options_.camera == node_name(index) || options_.camera == source.name;
        if (!wanted || has_camera_) return;
        has_camera_ = true;
        if (!make_rigid(world_from_camera)) fail("camera '" + node_name(index) + "': its axes are degenerate");
        Camera& camera = file_.camera;
        camera.world_from_camera = world_from_camera;
        camera.perspective = source.type == "perspective";
        double half_height = 0, half_width = 0;
        if (camera.perspective) {
            const tinygltf::PerspectiveCamera& lens = source.perspective;
            half_height = std::tan(0.5 * lens.yfov);
            half_width = half_height * (lens.aspectRatio > 0 ? lens.aspectRatio : double(file_.width) / file_.height);
            camera.clip_start = lens.znear;
            camera.clip_end = lens.zfar;  // 0: without end, see finish()
        } else {
            half_width = source.orthographic.xmag;
            half_height = source.orthographic.ymag;
            camera.clip_start = source.orthographic.znear;
            camera.clip_end = source.orthographic.zfar;
        }
        if (!(half_width > 0 && half_height > 0 && std::isfinite(half_width) && std::isfinite(half_height))) {
            fail("camera '" + node_name(index) + "': its field of view is empty");
        }
        camera.window = {-half_width, half_width, -half_height, half_height};
        const double aspect = half_width / half_height;
        if (!(aspect > 1e-3 && aspect < 1e3)) fail("camera '" + node_name(index) + "': its aspect ratio is absurd");
        file_.width = std::max(1, int(std::lround(file_.height * aspect)));
    }

    void add_light(int index, glm::dmat4 world_from_light) {
        const tinygltf::Node& node = model_.nodes[std::size_t(index)];
        const auto extension = node.extensions.find("KHR_lights_punctual");
        if (extension == node.extensions.end()) return;
        const tinygltf::Value& number = extension->second.Get("light");
        const int light_index = number.IsNumber() ? number.GetNumberAsInt() : -1;
        if (light_index < 0 || std::size_t(light_index) >= model_.lights.size()) {
            fail("node '" + node_name(index) + "': KHR_lights_punctual: light " + std::to_string(light_index) +
                 " does not exist");
        }
        const tinygltf::Light& source = model_.lights[std::size_t(light_index)];
        Light light;
        light.name = node.name.empty() ? (source.name.empty() ? node_name(index) : source.name) : node.name;
        if (!make_rigid(world_from_light)) fail("light '" + light.name + "': its axes are degenerate");
        light.world_from_light = world_from_light;
        if (source.color.size() == 3) light.color = glm::vec3(source.color[0], source.color[1], source.color[2]);
        if (source.type == "directional") {
            light.kind = LightKind::Sun;
            light.energy = source.intensity / kLumensPerWatt;  // lux to W/m2
        } else if (source.type == "point" || source.type == "spot") {
            light.kind = source.type == "point" ? LightKind::Point : LightKind::Spot;
            light.energy = source.intensity * 4.0 * pi / kLumensPerWatt;  // candela to W over the whole sphere
        } else {
            fail("light '" + light.name + "': type '" + source.type + "' is not directional, point or spot");
        }
        if (light.kind == LightKind::Spot) {
            const double outer = source.spot.outerConeAngle;
            if (!(outer > 0 && outer <= 0.5 * pi))
                fail("light '" + light.name + "': outerConeAngle is outside (0, pi/2]");
            light.spot_angle = 2.0 * outer;
            light.spot_blend = std::clamp(1.0 - source.spot.innerConeAngle / outer, 0.0, 1.0);
        }
        file_.scene->lights.push_back(std::move(light));
    }

    void finish() {
        if (!options_.camera.empty() && !has_camera_) {
            std::string names;
            for (const std::string& name : camera_names_) names += (names.empty() ? "" : ", ") + name;
            fail("it has no camera '" + options_.camera + "'; it has: " + (names.empty() ? "none" : names));
        }
        validate(*file_.scene);
        if (!has_camera_) add_default_camera(file_);
        if (file_.camera.perspective && file_.camera.clip_end == 0) set_far_clip();
        if (file_.scene->lights.empty()) add_default_light(file_);
        validate(file_.camera);
        file_.source = {{"format", "glTF"}, {"file", path_.filename().string()}, {"generator", model_.asset.generator}};
    }

    // A camera without far plane sees everything there is.
    void set_far_clip() {
        const WorldBounds bounds = compute_world_bounds(*file_.scene);
        const double distance = glm::length(bounds.centre() - glm::dvec3(file_.camera.world_from_camera[3]));
        file_.camera.clip_end = std::max(1.1 * (distance + bounds.radius()), 2.0 * file_.camera.clip_start);
    }

    std::filesystem::path path_;
    std::string place_;
    ReadOptions options_;
    tinygltf::Model model_;
    SceneFile file_;
    std::vector<int> mesh_of_;
    std::vector<bool> visited_;
    std::vector<std::string> camera_names_;
    bool has_camera_ = false;
};

}  // namespace

SceneFile read_gltf(const std::filesystem::path& path, const ReadOptions& options) {
    return GltfReader(path, options).read();
}

}  // namespace shadow_layers::io
