// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "io/scene_file.h"
#include "unit/io_support.h"

namespace shadow_layers::test {
namespace {

using nlohmann::json;
using std::numbers::pi;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

// A glTF document under construction, with one buffer.
struct Gltf {
    json document = {{"asset", {{"version", "2.0"}, {"generator", "test"}}},
                     {"scene", 0},
                     {"scenes", {{{"nodes", json::array()}}}},
                     {"nodes", json::array()},
                     {"meshes", json::array()}};
    std::string bytes;

    int add_view(const std::string& data, int stride = 0) {
        while (bytes.size() % 4 != 0) bytes += '\0';
        json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}};
        if (stride > 0) view["byteStride"] = stride;
        bytes += data;
        document["bufferViews"].push_back(view);
        return int(document["bufferViews"].size()) - 1;
    }
    int add_accessor(const std::string& data, int type, const char* shape, std::size_t count, int stride = 0,
                     bool normalized = false) {
        json accessor = {
            {"bufferView", add_view(data, stride)}, {"componentType", type}, {"type", shape}, {"count", count}};
        if (normalized) accessor["normalized"] = true;
        document["accessors"].push_back(accessor);
        return int(document["accessors"].size()) - 1;
    }
    int add_mesh(const json& primitives, const char* name = "Mesh") {
        document["meshes"].push_back({{"name", name}, {"primitives", primitives}});
        return int(document["meshes"].size()) - 1;
    }
    int add_node(const json& node, bool root = true) {
        document["nodes"].push_back(node);
        const int index = int(document["nodes"].size()) - 1;
        if (root) document["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    // Four corners of a square in x and y.
    int add_square() { return add_accessor(bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}), kFloat, "VEC3", 4); }
    std::string text() {
        document["buffers"] = {{{"uri", "scene.bin"}, {"byteLength", bytes.size()}}};
        return document.dump();
    }
};

class IoGltf : public FolderTest {
protected:
    io::SceneFile read(Gltf& gltf, const io::ReadOptions& options = {}) const {
        const std::string text = gltf.text();
        write("scene.bin", gltf.bytes);
        return io::read_scene_file(write("scene.gltf", text), options);
    }
    std::string error(Gltf& gltf) const {
        return error_of([&] { read(gltf); });
    }
    static bool warned(const io::SceneFile& file, const std::string& text) {
        for (const std::string& warning : file.warnings) {
            if (warning.find(text) != std::string::npos) return true;
        }
        return false;
    }
    // A square as two triangles under one node.
    static Gltf make_square() {
        Gltf gltf;
        const int positions = gltf.add_square();
        const int indices = gltf.add_accessor(bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3}), kUnsignedShort, "SCALAR", 6);
        gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}});
        gltf.add_node({{"mesh", 0}});
        return gltf;
    }
};

TEST_F(IoGltf, NodesAreComposedDownTheTree) {
    Gltf gltf = make_square();
    // Parent: moved by (10, 0, 0), turned 90 degrees about z. Child: moved by (1, 0, 0), scaled by 2.
    const double half = std::sqrt(0.5);
    const int child = gltf.add_node({{"mesh", 0}, {"translation", {1, 0, 0}}, {"scale", {2, 2, 2}}}, false);
    gltf.add_node({{"translation", {10, 0, 0}}, {"rotation", {0, 0, half, half}}, {"children", {child}}});
    const io::SceneFile file = read(gltf);
    ASSERT_EQ(file.scene->instances.size(), 2u);
    ASSERT_EQ(file.scene->meshes.size(), 1u) << "a mesh used twice is stored once";
    const glm::dvec3 corner(file.scene->instances[1].world_from_object * glm::dvec4(1, 0, 0, 1));
    // (1,0,0) * 2 + (1,0,0) = (3,0,0); turned: (0,3,0); moved: (10,3,0).
    EXPECT_NEAR(glm::length(corner - glm::dvec3(10, 3, 0)), 0, 1e-12);
    EXPECT_EQ(file.scene->instances[0].world_from_object, glm::dmat4(1.0));
}

TEST_F(IoGltf, MatricesAreColumnMajor) {
    Gltf gltf = make_square();
    gltf.document["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};
    EXPECT_EQ(glm::dvec3(read(gltf).scene->instances[0].world_from_object[3]), glm::dvec3(4, 5, 6));
}

TEST_F(IoGltf, AllModesAndIndexTypesGiveTriangles) {
    const struct {
        int mode;
        std::vector<std::uint32_t> corners;
        std::vector<glm::uvec3> triangles;
    } cases[] = {
        {4, {0, 1, 2, 0, 2, 3, 3}, {{0, 1, 2}, {0, 2, 3}}},
        {5, {0, 1, 3, 2}, {{0, 1, 3}, {1, 2, 3}}},  // a strip; its second triangle is turned
        {5, {0, 1, 3, 3, 3, 2}, {{0, 1, 3}}},       // sewn with triangles without area
        {6, {0, 1, 2, 3}, {{0, 1, 2}, {0, 2, 3}}},
    };
    for (const auto& item : cases) {
        for (const int type : {kUnsignedByte, kUnsignedShort, kUnsignedInt}) {
            Gltf gltf;
            const int positions = gltf.add_square();
            std::string data;
            if (type == kUnsignedByte)
                data = bytes_of(std::vector<std::uint8_t>(item.corners.begin(), item.corners.end()));
            if (type == kUnsignedShort)
                data = bytes_of(std::vector<std::uint16_t>(item.corners.begin(), item.corners.end()));
            if (type == kUnsignedInt) data = bytes_of(item.corners);
            const int indices = gltf.add_accessor(data, type, "SCALAR", item.corners.size());
            gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", item.mode}}});
            gltf.add_node({{"mesh", 0}});
            const io::SceneFile file = read(gltf);
            const Mesh& mesh = *file.scene->meshes[0];
            EXPECT_EQ(std::vector(mesh.triangles.begin(), mesh.triangles.end()), item.triangles)
                << item.mode << " " << type;
        }
    }
}

TEST_F(IoGltf, PrimitivesOfAMeshAreJoinedAndIndicesMayBeLeftOut) {
    Gltf gltf;
    const int a = gltf.add_accessor(bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}), kFloat, "VEC3", 3);
    const int b = gltf.add_accessor(bytes_of<float>({0, 0, 1, 1, 0, 1, 0, 1, 1}), kFloat, "VEC3", 3);
    gltf.add_mesh({{{"attributes", {{"POSITION", a}}}},
                   {{"attributes", {{"POSITION", b}}}},
                   {{"attributes", {{"POSITION", b}}}, {"mode", 1}}});
    gltf.add_node({{"mesh", 0}});
    const io::SceneFile file = read(gltf);
    ASSERT_EQ(file.scene->meshes.size(), 1u);
    EXPECT_EQ(file.scene->meshes[0]->triangles[1], glm::uvec3(3, 4, 5));
    EXPECT_EQ(file.scene->meshes[0]->positions[5], glm::vec3(0, 1, 1));
    EXPECT_TRUE(warned(file, "lines"));
}

TEST_F(IoGltf, InterleavedAndQuantizedPositionsAreRead) {
    {
        Gltf gltf;
        const int positions =
            gltf.add_accessor(bytes_of<float>({0, 0, 0, 9, 9, 1, 0, 0, 9, 9, 0, 1, 0, 9, 9}), kFloat, "VEC3", 3, 20);
        gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}}});
        gltf.add_node({{"mesh", 0}});
        EXPECT_EQ(read(gltf).scene->meshes[0]->positions[2], glm::vec3(0, 1, 0));
    }
    const struct {
        int type;
        std::string data;
        int stride;
        bool normalized;
        glm::vec3 last;
    } cases[] = {
        {kShort,
         bytes_of<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, -32768, 16384, 100, 0}),
         8,
         true,
         {-1, 16384 / 32767.0f, 100 / 32767.0f}},
        {kShort, bytes_of<std::int16_t>({0, 0, 0, 0, 1, 0, 0, 0, -7, 5, 3, 0}), 8, false, {-7, 5, 3}},
        {kUnsignedShort, bytes_of<std::uint16_t>({0, 0, 0, 0, 1, 0, 0, 0, 65535, 0, 13107, 0}), 8, true, {1, 0, 0.2f}},
        {kByte, bytes_of<std::int8_t>({0, 0, 0, 0, 1, 0, 0, 0, -128, 127, 0, 0}), 4, true, {-1, 1, 0}},
        {kUnsignedByte, bytes_of<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 255, 51, 0, 0}), 4, true, {1, 0.2f, 0}},
    };
    for (const auto& item : cases) {
        Gltf gltf;
        const int positions = gltf.add_accessor(item.data, item.type, "VEC3", 3, item.stride, item.normalized);
        gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}}});
        gltf.add_node({{"mesh", 0}});
        gltf.document["extensionsRequired"] = gltf.document["extensionsUsed"] = {"KHR_mesh_quantization"};
        const glm::vec3 got = read(gltf).scene->meshes[0]->positions[2];
        EXPECT_LT(glm::length(got - item.last), 1e-6) << item.type << item.normalized;
    }
}

TEST_F(IoGltf, SparseAccessorsReplaceSingleElements) {
    for (const bool with_base : {true, false}) {
        Gltf gltf;
        const int positions = gltf.add_square();
        const int sparse_indices = gltf.add_view(bytes_of<std::uint16_t>({1, 3}));
        const int sparse_values = gltf.add_view(bytes_of<float>({7, 8, 9, 4, 5, 6}));
        json& accessor = gltf.document["accessors"][std::size_t(positions)];
        accessor["sparse"] = {
            {"count", 2},
            {"indices", {{"bufferView", sparse_indices}, {"componentType", kUnsignedShort}, {"byteOffset", 0}}},
            {"values", {{"bufferView", sparse_values}, {"byteOffset", 0}}}};
        if (!with_base) accessor.erase("bufferView");
        const int indices = gltf.add_accessor(bytes_of<std::uint8_t>({0, 1, 2}), kUnsignedByte, "SCALAR", 3);
        gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}});
        gltf.add_node({{"mesh", 0}});
        const io::SceneFile file = read(gltf);
        const auto& mesh = *file.scene->meshes[0];
        EXPECT_EQ(mesh.positions[1], glm::vec3(7, 8, 9));
        EXPECT_EQ(mesh.positions[3], glm::vec3(4, 5, 6));
        EXPECT_EQ(mesh.positions[2], with_base ? glm::vec3(1, 1, 0) : glm::vec3(0));
    }
}

TEST_F(IoGltf, CamerasAreRead) {
    Gltf gltf = make_square();
    gltf.document["cameras"] = {
        {{"type", "perspective"},
         {"perspective", {{"yfov", 2 * std::atan(0.5)}, {"aspectRatio", 2.0}, {"znear", 0.5}, {"zfar", 50.0}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 3.0}, {"ymag", 1.5}, {"znear", 0.0}, {"zfar", 20.0}}}}};
    gltf.add_node({{"camera", 0}, {"name", "Wide"}, {"translation", {0, 0, 5}}, {"scale", {3, 3, 3}}});
    gltf.add_node({{"camera", 1}, {"name", "Flat"}});
    const io::SceneFile wide = read(gltf);
    EXPECT_TRUE(wide.camera.perspective);
    EXPECT_NEAR(wide.camera.window.top, 0.5, 1e-12);
    EXPECT_NEAR(wide.camera.window.left, -1.0, 1e-12);
    EXPECT_EQ(wide.camera.clip_start, 0.5);
    EXPECT_EQ(wide.camera.clip_end, 50.0);
    EXPECT_EQ(wide.width, 2 * wide.height);
    EXPECT_EQ(wide.camera.world_from_camera[0], glm::dvec4(1, 0, 0, 0)) << "scale is taken out";
    EXPECT_EQ(glm::dvec3(wide.camera.world_from_camera[3]), glm::dvec3(0, 0, 5));
    const io::SceneFile flat = read(gltf, {"Flat"});
    EXPECT_FALSE(flat.camera.perspective);
    EXPECT_EQ(flat.camera.window.right, 3.0);
    EXPECT_EQ(flat.camera.window.bottom, -1.5);
    EXPECT_NE(error_of([&] { read(gltf, {"Tele"}); }).find("Wide, Flat"), std::string::npos);
}

TEST_F(IoGltf, ACameraWithoutEndSeesEverything) {
    Gltf gltf = make_square();
    gltf.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
    gltf.add_node({{"camera", 0}, {"translation", {0, 0, 300}}});
    const io::SceneFile file = read(gltf);
    EXPECT_GT(file.camera.clip_end, 300);
    EXPECT_LT(file.camera.clip_end, 400);
}

TEST_F(IoGltf, LightsAreReadWithTheirUnits) {
    Gltf gltf = make_square();
    gltf.document["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"intensity", 683.0}, {"color", {1, 0.5, 0}}, {"name", "Sun"}},
        {{"type", "point"}, {"intensity", 683.0}},
        {{"type", "spot"}, {"intensity", 10.0}, {"spot", {{"innerConeAngle", 0.3}, {"outerConeAngle", 0.6}}}},
        {{"type", "spot"}, {"spot", json::object()}},
    };
    for (int i = 0; i < 4; ++i) {
        gltf.add_node({{"name", "L" + std::to_string(i)},
                       {"translation", {0, i, 0}},
                       {"scale", {2, 2, 2}},
                       {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    }
    const auto lights = read(gltf).scene->lights;
    ASSERT_EQ(lights.size(), 4u);
    EXPECT_EQ(lights[0].kind, LightKind::Sun);
    EXPECT_NEAR(lights[0].energy, 1.0, 1e-12) << "683 lux are 1 W/m2";
    EXPECT_EQ(lights[0].color, glm::vec3(1, 0.5, 0));
    EXPECT_EQ(lights[1].kind, LightKind::Point);
    EXPECT_NEAR(lights[1].energy, 4 * pi, 1e-12) << "683 cd are 1 W/sr";
    EXPECT_EQ(glm::dvec3(lights[1].world_from_light[3]), glm::dvec3(0, 1, 0));
    EXPECT_EQ(lights[2].kind, LightKind::Spot);
    EXPECT_NEAR(lights[2].spot_angle, 1.2, 1e-12);
    EXPECT_NEAR(lights[2].spot_blend, 0.5, 1e-12);
    EXPECT_NEAR(lights[3].spot_angle, pi / 2, 1e-9) << "the default of the extension";
    for (const Light& light : lights) EXPECT_NEAR(glm::length(glm::dvec3(light.world_from_light[0])), 1, 1e-12);
}

TEST_F(IoGltf, WhatIsMissingIsAddedAndSaid) {
    Gltf gltf = make_square();
    const io::SceneFile file = read(gltf);
    EXPECT_TRUE(warned(file, "no camera"));
    EXPECT_TRUE(warned(file, "no light"));
    ASSERT_EQ(file.scene->lights.size(), 1u);
    EXPECT_EQ(file.scene->lights[0].kind, LightKind::Sun);
}

TEST_F(IoGltf, BinaryFilesAreReadToo) {
    Gltf gltf = make_square();
    gltf.document["buffers"] = {{{"byteLength", gltf.bytes.size()}}};
    std::string text = gltf.document.dump();
    while (text.size() % 4 != 0) text += ' ';
    while (gltf.bytes.size() % 4 != 0) gltf.bytes += '\0';
    const auto word = [](std::size_t value) { return bytes_of<std::uint32_t>({std::uint32_t(value)}); };
    const std::string body =
        word(text.size()) + "JSON" + text + word(gltf.bytes.size()) + std::string("BIN\0", 4) + gltf.bytes;
    const std::string whole = "glTF" + word(2) + word(12 + body.size()) + body;
    EXPECT_EQ(io::read_scene_file(write("scene.glb", whole)).scene->meshes[0]->triangles.size(), 2u);
    for (std::size_t length = 0; length < whole.size(); length += 37) {
        error_of([&] { io::read_scene_file(write("cut.glb", whole.substr(0, length))); });
    }
}

TEST_F(IoGltf, BrokenFilesAreNamed) {
    const struct {
        std::function<void(json&)> change;
        std::string text;
    } cases[] = {
        {[](json& d) { d["accessors"][0]["count"] = 5; }, "beyond buffer view"},
        {[](json& d) { d["accessors"][0]["count"] = 4000000000u; }, "accessor"},
        {[](json& d) { d["accessors"][0]["byteOffset"] = 1000; }, "beyond buffer view"},
        {[](json& d) { d["accessors"][0]["type"] = "VEC2"; }, "VEC3"},
        {[](json& d) { d["accessors"][0]["bufferView"] = 9; }, "buffer view 9"},
        {[](json& d) { d["accessors"][0].erase("bufferView"); }, "without data"},
        {[](json& d) { d["bufferViews"][0]["byteLength"] = 100000; }, "reaches beyond its buffer"},
        {[](json& d) { d["bufferViews"][0]["buffer"] = 3; }, "buffer"},
        {[](json& d) { d["accessors"][1]["componentType"] = 5122; }, "unsigned"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["indices"] = 9; }, "accessor"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = -4; }, "accessor -4"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 7; }, "mode 7"},
        {[](json& d) { d["nodes"][0]["mesh"] = 4; }, "mesh 4"},
        {[](json& d) { d["nodes"][0]["children"] = {0}; }, "circle"},
        {[](json& d) { d["nodes"][0]["children"] = {8}; }, "node 8"},
        {[](json& d) {
             d["nodes"][0]["rotation"] = {0, 0, 0, 0};
         },
         "rotation"},
        {[](json& d) {
             d["nodes"][0]["matrix"] = {1, 2, 3};
         },
         "matrix"},
        {[](json& d) { d["nodes"][0]["camera"] = 3; }, "camera 3"},
        {[](json& d) { d["scene"] = 5; }, "scene 5"},
        {[](json& d) { d["scenes"] = json::array(); }, "scene"},
        {[](json& d) { d["asset"]["version"] = "1.0"; }, "version"},
        {[](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }, "KHR_draco_mesh_compression"},
        {[](json& d) {
             d["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 2}}}};
         },
         "light 2"},
    };
    for (const auto& item : cases) {
        Gltf gltf = make_square();
        item.change(gltf.document);
        const std::string text = error(gltf);
        EXPECT_NE(text.find(item.text), std::string::npos) << text << "\nwanted: " << item.text;
        EXPECT_NE(text.find("scene.gltf"), std::string::npos) << text;
    }
    Gltf gltf = make_square();
    const std::string text = gltf.text();
    std::filesystem::remove(folder_ / "scene.bin");
    EXPECT_NE(error_of([&] { io::read_scene_file(write("alone.gltf", text)); }).find("scene.bin"), std::string::npos);
    error_of([&] { io::read_scene_file(write("text.gltf", "not json")); });
    error_of([&] { io::read_scene_file(write("empty.gltf", "")); });
}

TEST_F(IoGltf, AnIndexBeyondTheVerticesIsNamed) {
    Gltf gltf;
    const int positions = gltf.add_square();
    const int indices = gltf.add_accessor(bytes_of<std::uint8_t>({0, 1, 4}), kUnsignedByte, "SCALAR", 3);
    gltf.add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}, "Roof");
    gltf.add_node({{"mesh", 0}});
    const std::string text = error(gltf);
    EXPECT_NE(text.find("'Roof'"), std::string::npos) << text;
    EXPECT_NE(text.find("index 4"), std::string::npos) << text;
}

}  // namespace
}  // namespace shadow_layers::test
