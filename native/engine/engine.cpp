// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/engine.h"

#include <algorithm>
#include <utility>

#include "context/context.h"
#include "engine/mesh_cache.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

gl::Device::LoadFunction loader() {
    return [](void* user, const char* name) { return static_cast<Context*>(user)->load(name); };
}

constexpr double kProgressMs = 30;
constexpr GLuint64 kBatchTimeoutNs = 60'000'000'000;  // a lost driver, not a slow one

}  // namespace

StageTimer::StageTimer(Engine& engine, std::string stage) : engine_(engine), stage_(std::move(stage)) {
    engine_.check_cancelled();
    if (engine_.record()) mark_ = engine_.record()->begin(engine_.device(), stage_);
}

StageTimer::~StageTimer() {
    try {
        if (engine_.record() && mark_.begin) engine_.record()->end(std::move(mark_));
        engine_.device().check(stage_);
    } catch (...) {
        if (!engine_.stage_error_) engine_.stage_error_ = std::current_exception();
    }
}

Engine::Engine(Context& context, const EngineOptions& options)
    : stages_(options.gpu_cache_bytes / 2), mesh_data_(options.host_cache_bytes) {
    // First, so that a wrong folder is reported before anything costly is made.
    sources_ = std::make_unique<gl::ShaderSource>(options.shader_dir);
    device_ = std::make_unique<gl::Device>(loader(), &context, options.debug);
    threads_ = std::make_unique<ThreadPool>(options.threads);
    meshes_ = std::make_unique<MeshCache>(options.gpu_cache_bytes / 2);
    empty_vertices_ = gl::VertexArray(*device_, "no vertices");
}

Engine::~Engine() {
    if (last_batch_) gl().DeleteSync(last_batch_);
}

const gl::Program& Engine::program(const std::string& vertex, const std::string& fragment, const gl::Defines& defines) {
    return program(std::vector<std::string>{vertex, fragment}, defines);
}

const gl::Program& Engine::program(const std::vector<std::string>& files, const gl::Defines& defines) {
    std::string name;
    for (const std::string& file : files) name += (name.empty() ? "" : " + ") + file;
    for (const auto& [define, value] : defines) name += " " + define + "=" + value;
    const auto found = programs_.find(name);
    if (found != programs_.end()) return found->second;
    std::vector<gl::Program::Stage> stages;
    for (const std::string& file : files) stages.push_back(sources_->load(file, defines));
    return programs_.emplace(name, gl::Program(*device_, stages, name)).first->second;
}

void Engine::begin_render() {
    ++render_number_;
    stages_.begin_render();
    mesh_data_.begin_render();
    meshes_->begin_render();
}

void Engine::check_cancelled() {
    cancel_.check();
    if (stage_error_) std::rethrow_exception(std::exchange(stage_error_, nullptr));
}

void Engine::set_progress(std::function<void(double)> progress) {
    progress_ = std::move(progress);
    progress_clock_ = WallClock();
    set_progress_part(0, 1);
}

void Engine::tell_progress(double fraction) {
    if (std::this_thread::get_id() != thread_ || !progress_ || progress_clock_.elapsed_ms() < kProgressMs) return;
    progress_clock_ = WallClock();
    progress_(progress_begin_ + std::clamp(fraction, 0.0, 1.0) * (progress_end_ - progress_begin_));
}

void Engine::check_gl(const char* where) {
    check_cancelled();
    device_->check(where);
}

void Engine::count(const std::string& counter, std::int64_t amount) {
    if (record_) record_->count(counter, amount);
}

void Engine::warn(const std::string& text) {
    if (std::find(warnings_.begin(), warnings_.end(), text) == warnings_.end()) warnings_.push_back(text);
}

std::vector<std::string> Engine::take_warnings() { return std::exchange(warnings_, {}); }

void Engine::draw_fullscreen(const DrawState& state) { draw_vertices(state, GL_TRIANGLES, 3); }

void Engine::draw_vertices(const DrawState& state, GLenum mode, GLsizei vertex_count) {
    apply(gl(), state);
    empty_vertices_.bind();
    gl().DrawArrays(mode, 0, vertex_count);
}

void Engine::drop_errors() {
    stage_error_ = nullptr;
    try {
        device_->check("the render before");
    } catch (const DriverError&) {
        // Told already, or part of what was cancelled.
    }
}

gl::Buffer& Engine::instance_stream(std::size_t bytes) {
    if (!instance_stream_ || instance_stream_.byte_size() < bytes) {
        const std::size_t grown = std::max<std::size_t>({bytes, instance_stream_.byte_size() * 2, 1 << 16});
        instance_stream_ = gl::Buffer();
        instance_stream_ = gl::Buffer(*device_, grown, "instances");
    } else {
        instance_stream_.orphan();
    }
    return instance_stream_;
}

void Engine::limit_queue() {
    GLsync batch = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl().Flush();
    const GLsync before = std::exchange(last_batch_, batch);
    if (!before) return;
    const GLenum answer = gl().ClientWaitSync(before, GL_SYNC_FLUSH_COMMANDS_BIT, kBatchTimeoutNs);
    gl().DeleteSync(before);
    if (answer == GL_ALREADY_SIGNALED || answer == GL_CONDITION_SATISFIED) return;
    check_gl("waiting for a batch of draws");
    throw DriverError("the GL driver (" + device_->renderer() + ") did not finish a batch of draws" +
                      (answer == GL_TIMEOUT_EXPIRED ? " in a minute" : "") +
                      "; it may have been lost: render again, or restart the program");
}

void Engine::finish() {
    gl().Finish();
    if (last_batch_) gl().DeleteSync(std::exchange(last_batch_, nullptr));
}

}  // namespace shadow_layers
