// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// The owners of GL objects, shader loading, timers: gl/.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "engine/scene_draw.h"
#include "gl_fixture.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

namespace fs = std::filesystem;
using GLObjects = test::EngineTest;

/// A shader folder of its own in the build's temporary place.
class ShaderFolder {
public:
    ShaderFolder() {
        path_ = fs::temp_directory_path() / ("shadow_layers_shaders_" + std::to_string(::getpid()) + "_" +
                                             ::testing::UnitTest::GetInstance()->current_test_info()->name());
        write("shared/conventions.h", "#pragma once\n");
    }
    ~ShaderFolder() { fs::remove_all(path_); }
    void write(const std::string& file, const std::string& text) const {
        fs::create_directories((path_ / file).parent_path());
        std::ofstream(path_ / file) << text;
    }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

template <class ErrorType, class Body>
std::string message_of(const Body& body) {
    try {
        body();
    } catch (const ErrorType& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST_F(GLObjects, TexturesKeepWhatIsUploaded) {
    gl::Texture floats(engine().device(), {GL_RGBA32F, 5, 3}, "floats");
    std::vector<float> values(5 * 3 * 4);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i) * 0.37f;
    floats.upload(values.data());
    EXPECT_EQ(floats.download<float>(), values);
    std::vector<float> part(2 * 2 * 4);
    floats.read(3, 1, 2, 2, part.data(), part.size() * sizeof(float));
    EXPECT_EQ(part[0], values[(1 * 5 + 3) * 4]);
    EXPECT_EQ(part[15], values[(2 * 5 + 4) * 4 + 3]);

    gl::Texture ids(engine().device(), {GL_RG32UI, 4, 2, 3}, "ids");
    std::vector<std::uint32_t> layer(16, 0xfffffff0u);
    ids.upload(layer.data(), 0, 2);
    EXPECT_EQ(ids.download<std::uint32_t>()[2 * 16], 0xfffffff0u);
    EXPECT_EQ(ids.byte_size(), 3u * 4 * 2 * 8);
}

TEST_F(GLObjects, AnyRowLengthIsTightlyPacked) {
    gl::Texture bytes(engine().device(), {GL_R8, 3, 3}, "odd");
    const std::vector<unsigned char> values = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    bytes.upload(values.data());
    EXPECT_EQ(bytes.download<unsigned char>(), values);
}

TEST_F(GLObjects, TooLargeTextureNamesSizeAndLimit) {
    const int limit = engine().limits().max_texture_size;
    const std::size_t before = engine().device().live_objects();
    const std::string text = message_of<DriverError>([&] {
        gl::Texture(engine().device(), {GL_R32F, limit + 1, 4}, "shadow map");
    });
    EXPECT_NE(text.find("shadow map"), std::string::npos) << text;
    EXPECT_NE(text.find(std::to_string(limit)), std::string::npos) << text;
    EXPECT_EQ(engine().device().live_objects(), before);
}

TEST_F(GLObjects, CountsWhatIsAlive) {
    const gl::Device& device = engine().device();
    const std::size_t objects = device.live_objects(), bytes = device.live_bytes();
    {
        gl::Texture first(device, {GL_R32F, 8, 8}, "first");
        gl::Buffer buffer(device, 100, "buffer");
        EXPECT_EQ(device.live_objects(), objects + 2);
        EXPECT_EQ(device.live_bytes(), bytes + 256 + 100);
        gl::Texture moved = std::move(first);
        EXPECT_EQ(device.live_bytes(), bytes + 256 + 100);
        EXPECT_EQ(moved.width(), 8);
        moved = gl::Texture(device, {GL_R32F, 4, 4}, "second");
        EXPECT_EQ(moved.width(), 4);
        EXPECT_EQ(device.live_bytes(), bytes + 64 + 100);
    }
    EXPECT_EQ(device.live_objects(), objects);
    EXPECT_EQ(device.live_bytes(), bytes);
}

TEST_F(GLObjects, BuffersReadAndWrite) {
    const std::vector<std::uint32_t> values = {1, 2, 3, 4};
    gl::Buffer buffer(engine().device(), std::span<const std::uint32_t>(values), "numbers");
    const std::uint32_t nine = 9;
    buffer.write(&nine, sizeof nine, 4);
    EXPECT_EQ(buffer.download<std::uint32_t>(4), (std::vector<std::uint32_t>{1, 9, 3, 4}));
    buffer.clear(7);
    EXPECT_EQ(buffer.download<std::uint32_t>(1, 12)[0], 7u);
}

TEST_F(GLObjects, FullscreenDrawFillsTheFramebuffer) {
    ShaderFolder folder;
    folder.write("shared/conventions.h", "#pragma once\n");
    folder.write("full.vert",
                 "void main() { gl_Position = vec4((gl_VertexID << 1 & 2) * 2 - 1, "
                 "(gl_VertexID & 2) * 2 - 1, 0, 1); }\n");
    folder.write("fill.frag", "uniform vec4 u_value;\nout vec4 o;\nvoid main() { o = u_value * SCALE; }\n");
    const gl::ShaderSource source(folder.path());
    const gl::Program program(engine().device(),
                              {source.load("full.vert", {}), source.load("fill.frag", {{"SCALE", "2.0"}})}, "fill");
    auto texture = std::make_shared<gl::Texture>(engine().device(), gl::TextureDesc{GL_RGBA32F, 6, 4}, "target");
    gl::Framebuffer framebuffer(engine().device(), "target");
    framebuffer.attach_color(0, texture);
    framebuffer.bind();
    framebuffer.clear_color(0, 5);
    EXPECT_EQ(texture->download<float>()[0], 5.0f);
    program.use();
    program.set("u_value", glm::vec4(1, 2, 3, 4));
    engine().draw_fullscreen();
    const auto pixels = texture->download<float>();
    for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_EQ(pixels[i], 2.0f * float(i % 4 + 1));
}

TEST_F(GLObjects, AUniformThatNoSourceHasIsAnError) {
    ShaderFolder folder;
    folder.write("full.vert", "void main() { gl_Position = vec4(0); }\n");
    folder.write("lib/used_lib.glsl", "uniform vec2 u_removed;\nuniform float u_list[3];\n");
    folder.write("fill.frag",
                 "#include \"lib/used_lib.glsl\"\n"
                 "#if 0\nlayout(location = 7) uniform highp vec4 u_left_out;\n#endif\n"
                 "uniform float u_value;  // uniform vec3 u_comment;\n"
                 "/* uniform vec3 u_remark; */\n"
                 "out vec4 u_out;\n"
                 "void main() { u_out = vec4(u_value + u_list[1]); }\n");
    const gl::ShaderSource source(folder.path());
    const gl::Program made(engine().device(), {source.load("full.vert", {}), source.load("fill.frag", {})}, "the fill");
    gl::Program program;
    program = gl::Program(engine().device(), {source.load("full.vert", {}), source.load("fill.frag", {})}, "the fill");
    program.set("u_value", 1.0f);
    program.set("u_list[1]", 1.0f);
    program.set("u_removed", glm::vec2(1));
    program.set("u_left_out", glm::vec4(1));
    for (const char* name : {"u_valve", "u_val", "u_comment", "u_remark", "u_out", "uniform", "u_lists[1]"}) {
        const std::string text = message_of<ShaderError>([&] { program.set(name, 1.0f); });
        EXPECT_NE(text.find("the fill"), std::string::npos) << text;
        EXPECT_NE(text.find('"' + std::string(name) + '"'), std::string::npos) << text;
    }
    EXPECT_NO_THROW(engine().check_gl("setting uniforms"));
}

/// What depends on how many views there may be takes it from kMaxViews.
TEST_F(GLObjects, ShadersTakeAnyNumberOfViews) {
    ShaderFolder folder;
    fs::copy(SHADOW_LAYERS_SHADER_DIR, folder.path(),
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    std::ifstream stream(folder.path() / "shared/view_choice.h");
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    const std::string count = "kMaxViews = 6;";
    ASSERT_NE(text.find(count), std::string::npos);
    folder.write("shared/view_choice.h", text.replace(text.find(count), count.size(), "kMaxViews = 9;"));
    const gl::ShaderSource source(folder.path());
    const gl::Defines defines{{"MIPMAPS", "1"}, {"ANISOTROPY", "4"}, {"FIXED_POINT", "0"}, {"COMPONENTS", "4"},
                              {"KERNEL", "3"},  {"BILINEAR", "1"},   {"EARLY_OUT", "1"},   {"SOFT", "1"}};
    for (const char* id : {"sm", "pcf", "edsm", "vsm", "esm", "evsm", "msm"}) {
        const std::string file = std::string("techniques/") + id + "/" + id + ".frag";
        EXPECT_NO_THROW(gl::Program(engine().device(),
                                    {source.load("frame/fullscreen.vert", {}), source.load(file, defines)}, file))
            << id;
    }
}

TEST_F(GLObjects, CompileErrorNamesFileAndLineThroughIncludes) {
    ShaderFolder folder;
    folder.write("lib/good_lib.glsl", "#pragma once\nfloat one() { return 1.0; }\n");
    folder.write("lib/bad_lib.glsl", "#pragma once\n#include \"good_lib.glsl\"\nfloat two() { return one() + }\n");
    folder.write("bad.frag", "#include \"lib/good_lib.glsl\"\n#include \"lib/bad_lib.glsl\"\nvoid main() {}\n");
    folder.write("late.frag", "#include \"lib/good_lib.glsl\"\n\nvoid main() {\n    undeclared = one();\n}\n");
    const gl::ShaderSource source(folder.path());
    const auto compile = [&](const char* file) {
        return message_of<ShaderError>([&] { gl::Program(engine().device(), {source.load(file, {})}, file); });
    };
    EXPECT_NE(compile("bad.frag").find("lib/bad_lib.glsl:3"), std::string::npos) << compile("bad.frag");
    EXPECT_NE(compile("late.frag").find("late.frag:4"), std::string::npos) << compile("late.frag");
}

TEST_F(GLObjects, LinkErrorNamesTheProgram) {
    ShaderFolder folder;
    folder.write("a.vert", "out vec3 v_value;\nvoid main() { v_value = vec3(0); gl_Position = vec4(0); }\n");
    folder.write("a.frag", "in float v_value;\nout float o;\nvoid main() { o = v_value; }\n");
    const gl::ShaderSource source(folder.path());
    const std::size_t before = engine().device().live_objects();
    const std::string text = message_of<ShaderError>([&] {
        gl::Program(engine().device(), {source.load("a.vert", {}), source.load("a.frag", {})}, "mismatch");
    });
    EXPECT_NE(text.find("mismatch"), std::string::npos) << text;
    EXPECT_EQ(engine().device().live_objects(), before);
}

TEST(ShaderSource, MissingThingsAreNamedWithTheRemedy) {
    const std::string folder_text = message_of<ShaderError>([] { gl::ShaderSource("/nowhere/shaders"); });
    EXPECT_NE(folder_text.find("/nowhere/shaders"), std::string::npos) << folder_text;
    EXPECT_NE(folder_text.find("reinstall"), std::string::npos) << folder_text;
    EXPECT_NE(message_of<ShaderError>([] { gl::ShaderSource(""); }).find("no shader folder"), std::string::npos);
    const std::string other = message_of<ShaderError>([] { gl::ShaderSource(fs::temp_directory_path()); });
    EXPECT_NE(other.find("holds no shaders"), std::string::npos) << other;

    ShaderFolder folder;
    folder.write("a.frag", "\n\n#include \"lib/missing_lib.glsl\"\nvoid main() {}\n");
    folder.write("ring_a.frag", "#include \"ring_b.glsl\"\n");
    folder.write("ring_b.glsl", "#include \"ring_a.frag\"\n");
    const gl::ShaderSource source(folder.path());
    const std::string include = message_of<ShaderError>([&] { source.load("a.frag", {}); });
    EXPECT_NE(include.find("a.frag:3"), std::string::npos) << include;
    EXPECT_NE(include.find("missing_lib.glsl"), std::string::npos) << include;
    EXPECT_NE(message_of<ShaderError>([&] { source.load("ring_a.frag", {}); }).find("circle"), std::string::npos);
    EXPECT_NE(message_of<ShaderError>([&] { source.load("none.frag", {}); }).find("none.frag"), std::string::npos);
    EXPECT_NE(message_of<ShaderError>([&] { source.load("a.txt", {}); }).find(".frag"), std::string::npos);
}

TEST(ShaderSource, PragmaOncePastesOnce) {
    ShaderFolder folder;
    folder.write("lib/once_lib.glsl", "#pragma once\nint marker;\n");
    folder.write("a.frag", "#include \"lib/once_lib.glsl\"\n#include \"lib/once_lib.glsl\"\nvoid main() {}\n");
    const std::string text = gl::ShaderSource(folder.path()).load("a.frag", {{"SIZE", "4"}}).source;
    EXPECT_EQ(text.find("int marker"), text.rfind("int marker"));
    EXPECT_NE(text.find("#define SIZE 4"), std::string::npos);
}

TEST(ShaderSource, NamesFilesInLogsOfSeveralDrivers) {
    const std::vector<std::string> files = {"a.frag", "lib/b_lib.glsl"};
    EXPECT_EQ(gl::name_files_in_log("1:12(3): error: x\n", files), "lib/b_lib.glsl:12(3): error: x\n");
    EXPECT_EQ(gl::name_files_in_log("0(7) : error C0000: y\n", files), "a.frag:7 : error C0000: y\n");
    EXPECT_EQ(gl::name_files_in_log("ERROR: 1:9: z\n", files), "ERROR: lib/b_lib.glsl:9: z\n");
    EXPECT_EQ(gl::name_files_in_log("no place\n", files), "no place\n");
    EXPECT_EQ(gl::name_files_in_log("9:1: unknown file\n", files), "9:1: unknown file\n");
}

TEST_F(GLObjects, ErrorsAreFoundAndNamed) {
    engine().gl().Enable(0x1234);
    const std::string text = message_of<DriverError>([&] { engine().check_gl("a test's stage"); });
    EXPECT_NE(text.find("a test's stage"), std::string::npos) << text;
    EXPECT_NE(text.find("GL_INVALID_ENUM"), std::string::npos) << text;
    EXPECT_NO_THROW(engine().check_gl("later"));
    // Inside a stage the error waits for the next call that may throw.
    {
        const auto timer = engine().time_stage("broken stage");
        engine().gl().Enable(0x1234);
    }
    EXPECT_NE(message_of<DriverError>([&] { engine().check_cancelled(); }).find("broken stage"), std::string::npos);
}

TEST_F(GLObjects, ACancelIsToldBeforeTheErrorsThatItLeaves) {
    engine().gl().Enable(0x1234);
    engine().cancel_token().request();
    EXPECT_THROW(engine().check_gl("a stage"), Cancelled);
    engine().cancel_token().reset();
    EXPECT_THROW(engine().check_gl("a stage"), DriverError);
}

/// The functions of this test's own GL, to put others in their place.
GladGLContext& functions_of(Engine& engine) { return const_cast<GladGLContext&>(engine.gl()); }

TEST_F(GLObjects, WhatTheEndOfAStageThrowsIsToldLater) {
    StageRecord record;
    engine().set_record(&record);
    const auto flush = functions_of(engine()).Flush;
    EXPECT_NO_THROW({
        const auto timer = engine().time_stage("no memory at its end");
        functions_of(engine()).Flush = []() { throw std::bad_alloc(); };
    });
    functions_of(engine()).Flush = flush;
    engine().set_record(nullptr);
    EXPECT_THROW(engine().check_cancelled(), std::bad_alloc);
    EXPECT_NO_THROW(engine().check_cancelled());
}

TEST_F(GLObjects, ALostDriverIsAnErrorAndNoSuccess) {
    const auto wait = functions_of(engine()).ClientWaitSync;
    const auto limit_with = [&](PFNGLCLIENTWAITSYNCPROC answer) {
        functions_of(engine()).ClientWaitSync = answer;
        engine().limit_queue();  // the first one has no batch before it to wait for
        engine().limit_queue();
        functions_of(engine()).ClientWaitSync = wait;
    };
    EXPECT_NO_THROW(limit_with(wait));
    EXPECT_NO_THROW(limit_with([](GLsync, GLbitfield, GLuint64) -> GLenum { return GL_ALREADY_SIGNALED; }));
    EXPECT_NO_THROW(limit_with([](GLsync, GLbitfield, GLuint64) -> GLenum { return GL_CONDITION_SATISFIED; }));
    const auto timed_out = [](GLsync, GLbitfield, GLuint64) -> GLenum { return GL_TIMEOUT_EXPIRED; };
    const auto failed = [](GLsync, GLbitfield, GLuint64) -> GLenum { return GL_WAIT_FAILED; };
    const std::string text = message_of<DriverError>([&] { limit_with(timed_out); });
    EXPECT_NE(text.find(engine().device().renderer()), std::string::npos) << text;
    EXPECT_NE(text.find("minute"), std::string::npos) << text;
    EXPECT_THROW(limit_with(failed), DriverError);
    engine().cancel_token().request();
    EXPECT_THROW(limit_with(failed), Cancelled);
    engine().cancel_token().reset();
    functions_of(engine()).ClientWaitSync = wait;
    EXPECT_NO_THROW(limit_with(wait));
}

TEST_F(GLObjects, StageTimesAddUpByName) {
    StageRecord record;
    engine().set_record(&record);
    for (int i = 0; i < 3; ++i) {
        const auto timer = engine().time_stage("clear");
        gl::Texture texture(engine().device(), {GL_R32F, 64, 64}, "target");
        const float one = 1;
        texture.clear(&one);
        engine().count("texels", 4096);
    }
    { const auto timer = engine().time_stage("other"); }
    engine().set_record(nullptr);
    const RenderStats stats = record.stats();
    ASSERT_EQ(stats.times.size(), 2u);
    EXPECT_EQ(stats.times[0].stage, "clear");
    EXPECT_GE(stats.times[0].cpu_ms, 0);
    EXPECT_GE(stats.times[0].gl_ms, 0);
    EXPECT_EQ(stats.counters.at("texels"), 3 * 4096);
}

TEST_F(GLObjects, ProgramsAreCompiledOnce) {
    const gl::Program& first = engine().program("frame/visibility.vert", "frame/visibility.frag");
    const std::size_t objects = engine().device().live_objects();
    EXPECT_EQ(&first, &engine().program("frame/visibility.vert", "frame/visibility.frag"));
    EXPECT_NE(&first, &engine().program("frame/visibility.vert", "frame/visibility.frag", {{"OTHER", "1"}}));
    EXPECT_EQ(engine().device().live_objects(), objects + 1);
}

}  // namespace
}  // namespace shadow_layers
