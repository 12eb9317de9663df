// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "io/npy.h"
#include "io/scene_file.h"
#include "unit/io_support.h"

namespace shadow_layers::test {
namespace {

using Members = std::map<std::string, std::string>;

class IoSnapshot : public FolderTest {
protected:
    io::SceneFile read(const Members& members) const {
        write_zip(folder_ / "scene.npz", members);
        return io::read_scene_file(folder_ / "scene.npz");
    }
    std::string error(const Members& members) const {
        return error_of([&] { read(members); });
    }
    // The members with one JSON value changed, by its pointer ("/camera/clip_end").
    static Members with_json(const std::string& pointer, const nlohmann::json& value) {
        Members members = make_snapshot_members();
        nlohmann::json json = make_snapshot_json();
        json[nlohmann::json::json_pointer(pointer)] = value;
        members["snapshot.json"] = json.dump();
        return members;
    }
};

TEST_F(IoSnapshot, EveryFieldArrives) {
    const io::SceneFile file = read(make_snapshot_members());
    ASSERT_EQ(file.scene->meshes.size(), 2u);
    EXPECT_EQ(file.scene->meshes[1]->name, "Leaf");
    ASSERT_EQ(file.scene->meshes[0]->positions.size(), 4u);
    EXPECT_EQ(file.scene->meshes[0]->positions[2], glm::vec3(1, 0, 1));
    EXPECT_EQ(file.scene->meshes[0]->triangles[1], glm::uvec3(0, 2, 3));
    ASSERT_EQ(file.scene->instances.size(), 3u);
    const Instance& instance = file.scene->instances[2];
    EXPECT_EQ(instance.mesh, 1u);
    EXPECT_EQ(instance.flags, kInstanceCamera | kInstanceHoldout);
    EXPECT_EQ(instance.receiver_group, 63);
    EXPECT_EQ(instance.blocker_group, 4);
    EXPECT_EQ(glm::dvec3(instance.world_from_object[3]), glm::dvec3(1, 2, 3)) << "matrices are row-major in the file";

    ASSERT_EQ(file.scene->lights.size(), 1u);
    const Light& light = file.scene->lights[0];
    EXPECT_EQ(light.name, "Key");
    EXPECT_EQ(light.kind, LightKind::Spot);
    EXPECT_EQ(glm::dvec3(light.world_from_light[3]), glm::dvec3(5, 6, 7));
    EXPECT_EQ(light.color, glm::vec3(1, 0.5, 0.25));
    EXPECT_EQ(light.energy, 100.5);
    EXPECT_EQ(light.radius, 0.25);
    EXPECT_EQ(light.sun_angle, 0.01);
    EXPECT_EQ(light.spot_angle, 0.75);
    EXPECT_EQ(light.spot_blend, 0.5);
    EXPECT_EQ(light.area_size, glm::dvec2(2, 3));
    EXPECT_TRUE(light.area_round);
    EXPECT_FALSE(light.casts_shadow);
    EXPECT_EQ(light.receiver_set, 0xfffffffffffffffeull);
    EXPECT_EQ(light.blocker_set, 0x8000000000000001ull);

    EXPECT_TRUE(file.camera.perspective);
    EXPECT_EQ(file.camera.window.top, 0.5);
    EXPECT_EQ(file.camera.clip_end, 100);
    EXPECT_EQ(file.width, 640);
    EXPECT_EQ(file.height, 320);
    EXPECT_EQ(file.region.x, 10);
    EXPECT_EQ(file.region.height, 200);
    EXPECT_EQ(file.samples, 4);
    EXPECT_EQ(file.filter.kind, PixelFilterKind::Gaussian);
    EXPECT_EQ(file.filter.width_px, 2.5);
    ASSERT_EQ(file.jobs.size(), 1u);
    EXPECT_EQ(file.jobs[0].technique, "sm");
    EXPECT_EQ(file.jobs[0].parameters.get_int("map_size"), 512);
    EXPECT_EQ(file.jobs[0].parameters.get_float("a"), 0.5);
    EXPECT_TRUE(file.jobs[0].parameters.get_bool("b"));
    EXPECT_EQ(file.jobs[0].parameters.get_enum("c"), "x");
    EXPECT_EQ(file.warnings, std::vector<std::string>{"hair was left out"});
    EXPECT_EQ(file.source.at("frame"), 7);
}

TEST_F(IoSnapshot, StoredMembersAndMissingNamesAreReadToo) {
    Members members = make_snapshot_members();
    nlohmann::json json = make_snapshot_json();
    json.erase("instances");
    members["snapshot.json"] = json.dump();
    write_zip(folder_ / "scene.npz", members, false);
    EXPECT_EQ(io::read_snapshot(folder_ / "scene.npz").scene->instances.size(), 3u);
}

TEST_F(IoSnapshot, AnEmptySceneIsAScene) {
    Members members = make_snapshot_members();
    nlohmann::json json = make_snapshot_json();
    json["meshes"] = json["instances"] = json["lights"] = json["jobs"] = nlohmann::json::array();
    members["snapshot.json"] = json.dump();
    members["instance_mesh.npy"] = members["instance_flags.npy"] = make_npy("<u4", "(0,)", "");
    members["instance_matrix.npy"] = make_npy("<f8", "(0, 4, 4)", "");
    members["instance_receiver_group.npy"] = members["instance_blocker_group.npy"] = make_npy("|u1", "(0,)", "");
    EXPECT_TRUE(read(members).scene->instances.empty());
}

TEST_F(IoSnapshot, MissingMembersAreNamed) {
    for (const auto& [name, bytes] : make_snapshot_members()) {
        Members members = make_snapshot_members();
        members.erase(name);
        EXPECT_NE(error(members).find(name), std::string::npos) << name;
    }
}

TEST_F(IoSnapshot, BadArraysAreNamedWithTheRemedy) {
    const std::string zeros(4096, '\0');
    const struct {
        std::string member, bytes, text;
    } cases[] = {
        {"mesh_positions_0", make_npy("<f8", "(4, 3)", zeros.substr(0, 96)), "astype('<f4')"},
        {"mesh_positions_0", make_npy(">f4", "(4, 3)", zeros.substr(0, 48)), "'>f4'"},
        {"mesh_positions_0", make_npy("<f4", "(4, 3)", zeros.substr(0, 48), "True"), "ascontiguousarray"},
        {"mesh_positions_0", make_npy("<f4", "(4, 2)", zeros.substr(0, 32)), "(4, 2, )"},
        {"mesh_positions_0", make_npy("<f4", "(12,)", zeros.substr(0, 48)), "wanted (n, 3, )"},
        {"mesh_positions_0", make_npy("<f4", "(4, 3)", zeros.substr(0, 47)), "cut off: 47 of 48"},
        {"mesh_positions_0", make_npy("<f4", "(4, 3)", zeros.substr(0, 49)), "goes on"},
        {"mesh_positions_0", make_npy("<f4", "(4611686018427387904, 3)", zeros), "too large"},
        {"mesh_positions_0", make_npy("<f4", "(99999999999999999999999, 3)", zeros), "too large"},
        {"mesh_positions_0", make_npy("<f4", "(1000000000, 3)", zeros), "cut off"},
        {"mesh_positions_0", make_npy("<f4", "(-4, 3)", zeros), "whole numbers"},
        {"mesh_positions_0", "", "not a .npy"},
        {"mesh_positions_0", "\x93NUMPY", "not a .npy"},
        {"mesh_positions_0", std::string("\x93NUMPY\x09\0\x10\0", 10) + zeros, "version 9"},
        {"mesh_positions_0", std::string("\x93NUMPY\x01\0\xff\xff", 10), "64 KiB"},
        {"mesh_positions_0", std::string("\x93NUMPY\x01\0\xf0\0", 10), "cut off in its header"},
        {"mesh_positions_0", std::string("\x93NUMPY\x02\0\xff\xff\xff\xff", 12) + zeros, "64 KiB"},
        {"instance_matrix", make_npy("<f8", "(2, 4, 4)", zeros.substr(0, 256)), "wanted (3, 4, 4, )"},
        {"instance_flags", make_npy("<i4", "(3,)", zeros.substr(0, 12)), "'<i4'"},
    };
    for (const auto& item : cases) {
        Members members = make_snapshot_members();
        members[item.member + ".npy"] = item.bytes;
        const std::string text = error(members);
        EXPECT_NE(text.find(item.member), std::string::npos) << text;
        EXPECT_NE(text.find(item.text), std::string::npos) << text << "\nwanted: " << item.text;
    }
}

TEST_F(IoSnapshot, BadFieldsAreNamedByTheirPlace) {
    const struct {
        std::string pointer;
        nlohmann::json value;
        std::string place, text;
    } cases[] = {
        {"/format", "something", "format", "shadow-layers-snapshot"},
        {"/version", 2, "version", "2 cannot be read by this program, which reads version 1"},
        {"/camera/clip_end", "far", "camera.clip_end", "number"},
        {"/camera/window", {1, 2, 3}, "camera.window", "4 numbers, got 3"},
        {"/camera/world_from_camera/2", {1, 2}, "camera.world_from_camera[2]", "4 numbers"},
        {"/lights/0/kind", "HEMI", "lights[0].kind", "SUN, SPOT, POINT or AREA"},
        {"/lights/0/receiver_set", "xyz", "lights[0].receiver_set", "hexadecimal"},
        {"/lights/0/blocker_set", "1ffffffffffffffff", "lights[0].blocker_set", "hexadecimal"},
        {"/lights/0/casts_shadow", 1, "lights[0].casts_shadow", "true or false"},
        {"/lights", "none", "lights", "list"},
        {"/render/width", 0, "render.width", "whole number"},
        {"/render/width", 1.5, "render.width", "whole number"},
        {"/render/samples", 65, "render.samples", "whole number"},
        {"/render/filter", "LANCZOS", "render.filter", "BLACKMAN_HARRIS"},
        {"/render/region", {0, 0, 3}, "render.region", "[x, y, width, height]"},
        {"/jobs/0/light", 1, "jobs[0].light", "beyond the 1 lights"},
        {"/jobs/0/parameters/map_size", nullptr, "jobs[0].parameters.map_size", "number"},
        {"/jobs/0/parameters/map_size", 18446744073709551615ull, "jobs[0].parameters.map_size", "too large"},
        {"/meshes/0", "Ground", "meshes[0]", "object"},
        {"/source", 5, "source", "object"},
    };
    for (const auto& item : cases) {
        const std::string text = error(with_json(item.pointer, item.value));
        EXPECT_NE(text.find(item.place), std::string::npos) << text;
        EXPECT_NE(text.find(item.text), std::string::npos) << text << "\nwanted: " << item.text;
    }
}

TEST_F(IoSnapshot, EveryRequiredKeyIsMissed) {
    const nlohmann::json whole = make_snapshot_json();
    const nlohmann::json flat = whole.flatten();
    for (const auto& [key, value] : flat.items()) {
        if (key.starts_with("/source") || key.starts_with("/instances") || key.starts_with("/jobs/0/parameters/"))
            continue;
        const nlohmann::json::json_pointer pointer(key);
        if (whole.at(pointer.parent_pointer()).is_array()) continue;
        nlohmann::json json = whole;
        json.at(pointer.parent_pointer()).erase(pointer.back());
        Members members = make_snapshot_members();
        members["snapshot.json"] = json.dump();
        EXPECT_NE(error(members).find("'" + pointer.back() + "' is missing"), std::string::npos) << key;
    }
}

TEST_F(IoSnapshot, WrongScenesAreInputErrors) {
    Members members = make_snapshot_members();
    members["mesh_triangles_1.npy"] = make_npy("<u4", "(1, 3)", bytes_of<std::uint32_t>({0, 1, 3}));
    EXPECT_NE(error_of<InputError>([&] { read(members); }).find("Leaf"), std::string::npos);
    members = make_snapshot_members();
    members["instance_mesh.npy"] = make_npy("<u4", "(3,)", bytes_of<std::uint32_t>({0, 1, 2}));
    error_of<InputError>([&] { read(members); });
    error_of<InputError>([&] { read(with_json("/lights/0/spot_angle", 4.0)); });
    error_of<InputError>([&] { read(with_json("/camera/clip_end", 0.05)); });
}

TEST_F(IoSnapshot, FilesThatAreNoSnapshotsAreRefused) {
    const auto text_of = [&](const std::string& name, const std::string& bytes) {
        return error_of([&] { io::read_scene_file(write(name, bytes)); });
    };
    EXPECT_NE(text_of("empty.npz", "").find("empty.npz"), std::string::npos);
    EXPECT_NE(text_of("text.npz", "no zip file at all, but long enough to be looked at").find("archive"),
              std::string::npos);
    EXPECT_NE(text_of("scene.xyz", "").find(".npz"), std::string::npos);
    EXPECT_NE(error_of([&] { io::read_scene_file(folder_ / "nowhere.npz"); }).find("no such file"), std::string::npos);
    EXPECT_NE(error_of([&] { io::read_scene_file(folder_); }).find("folder"), std::string::npos);
    write_zip(folder_ / "other.npz", {{"array.npy", make_npy("<f4", "(1,)", "abcd")}});
    EXPECT_NE(error_of([&] { io::read_scene_file(folder_ / "other.npz"); }).find("snapshot.json"), std::string::npos);
    for (const char* json : {"", "{", "[]", "\"text\"", "{\"format\": NaN}", "\xff\xfe"}) {
        Members members = make_snapshot_members();
        members["snapshot.json"] = json;
        EXPECT_NE(error(members).find("snapshot.json"), std::string::npos) << json;
    }
}

TEST_F(IoSnapshot, DeeplyNestedJsonIsRefused) {
    Members members = make_snapshot_members();
    members["snapshot.json"] = std::string(2'000'000, '[');
    error(members);
}

TEST_F(IoSnapshot, CutOffArchivesAreRefused) {
    write_zip(folder_ / "whole.npz", make_snapshot_members());
    std::ifstream stream(folder_ / "whole.npz", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    for (std::size_t length = 0; length < bytes.size(); length += 97) {
        EXPECT_THROW(io::read_scene_file(write("cut.npz", bytes.substr(0, length))), FileError) << length;
    }
}

// Whatever the bytes, the reader answers with a scene or with an error of ours: never a crash, a hang, or another
// error.
class IoSnapshotFuzz : public IoSnapshot {
protected:
    std::string mutate(std::string bytes) {
        const auto below = [&](std::size_t n) { return n == 0 ? 0 : std::size_t(random_() % n); };
        for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
            const std::size_t place = below(bytes.size());
            switch (below(6)) {
                case 0:
                    bytes.insert(place, 1 + below(8), char(random_()));
                    break;
                case 1:
                    bytes.erase(place, 1 + below(16));
                    break;
                case 2:
                    bytes.resize(place);
                    break;
                case 3:
                    bytes.insert(place, bytes.substr(below(bytes.size() + 1), below(64)));
                    break;
                case 4:
                    bytes.insert(place, kTokens[below(std::size(kTokens))]);
                    break;
                default:
                    if (!bytes.empty()) bytes[place] = char(random_());
            }
        }
        return bytes;
    }
    void expect_answer(const std::function<void()>& action, unsigned round) {
        try {
            action();
            ++read_;
        } catch (const Error&) {
            ++refused_;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "round " << round << ": " << error.what();
        }
    }

    static constexpr const char* kTokens[] = {"{",    "}",         "[",       "]",     "(",           ")",
                                              ",",    "'",         "-1",      "1e999", "99999999999", "null",
                                              "True", "'shape': ", "\\u0000", "\x80"};
    std::mt19937 random_{20260711};
    int read_ = 0, refused_ = 0;
};

TEST_F(IoSnapshotFuzz, MutatedMembers) {
    const Members whole = make_snapshot_members();
    for (unsigned round = 0; round < 3000; ++round) {
        Members members = whole;
        auto target = members.begin();
        std::advance(target, random_() % members.size());
        target->second = mutate(target->second);
        expect_answer([&] { read(members); }, round);
    }
    EXPECT_GT(refused_, 1000);
    EXPECT_GT(read_, 10) << "some mutations leave a good file: the fuzzer reaches the inside";
}

TEST_F(IoSnapshotFuzz, MutatedArchives) {
    write_zip(folder_ / "whole.npz", make_snapshot_members(), false);
    std::ifstream stream(folder_ / "whole.npz", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    for (unsigned round = 0; round < 2000; ++round) {
        expect_answer([&] { io::read_scene_file(write("mutated.npz", mutate(bytes))); }, round);
    }
    EXPECT_GT(refused_, 1000);
}

TEST(IoNpy, HeadersOfAllVersionsAreRead) {
    const std::string dict = "{\"descr\": \"<f4\", 'fortran_order': False, 'shape': (2, 3,)}";
    for (const char version : {1, 2, 3}) {
        std::string text = std::string("\x93NUMPY") + version + '\0' + char(dict.size()) + '\0';
        if (version > 1) text += std::string(2, '\0');
        text += dict;
        const io::NpyHeader header = io::parse_npy_header(std::as_bytes(std::span(text)));
        EXPECT_EQ(header.descr, "<f4");
        EXPECT_EQ(header.shape, (std::vector<std::size_t>{2, 3}));
        EXPECT_EQ(header.data_offset, text.size());
        EXPECT_EQ(io::check_npy_header(header, {"<f4", {-1, 3}}), 24u);
    }
}

TEST(IoNpy, BadDictsAreRefused) {
    for (const std::string dict :
         {"", "{}", "{'descr': '<f4'}", "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': ()}",
          "{'descr': '<f4', 'fortran_order': Maybe, 'shape': ()}",
          "{'descr': '<f4', 'fortran_order': False, 'shape': 3}",
          "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': ()}",
          "{'descr': '<f4', 'fortran_order': False, 'shape': (), 'extra': 1}",
          "{'descr': '<f4', 'fortran_order': False, 'shape': ()} + exit()", "{'descr': '<f4"}) {
        const std::string text = std::string("\x93NUMPY\x01") + '\0' + char(dict.size()) + '\0' + dict;
        EXPECT_THROW(io::parse_npy_header(std::as_bytes(std::span(text))), FileError) << dict;
    }
}

}  // namespace
}  // namespace shadow_layers::test
