// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/timer_query.h"

namespace shadow_layers::gl {
namespace {

GLuint create_query(const Device& device) {
    GLuint id = 0;
    device.gl().CreateQueries(GL_TIMESTAMP, 1, &id);
    return id;
}

}  // namespace

TimerQuery::TimerQuery(const Device& device) : Tracked(device, create_query(device), 0, {}) {}

TimerQuery& TimerQuery::operator=(TimerQuery&& other) noexcept {
    Tracked::operator=(std::move(other));
    return *this;
}

TimerQuery::~TimerQuery() {
    if (!id()) return;
    const GladGLContext& functions = gl();
    const GLuint name = take();
    functions.DeleteQueries(1, &name);
}

void TimerQuery::mark() { gl().QueryCounter(id(), GL_TIMESTAMP); }

double TimerQuery::wait_ms() const {
    GLuint64 nanoseconds = 0;
    gl().GetQueryObjectui64v(id(), GL_QUERY_RESULT, &nanoseconds);
    return double(nanoseconds) * 1e-6;
}

}  // namespace shadow_layers::gl
