# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# The GL loader: glad generates one header with a table per context (nothing global, nothing linked).
find_program(GLAD_EXECUTABLE glad REQUIRED)
set(GLAD_INCLUDE_DIR ${CMAKE_BINARY_DIR}/glad/include)
set(GLAD_HEADER ${GLAD_INCLUDE_DIR}/glad/gl.h)
add_custom_command(
    OUTPUT ${GLAD_HEADER}
    COMMAND ${GLAD_EXECUTABLE} --quiet --reproducible --api gl:core=4.5 --extensions GL_KHR_debug
            --out-path ${CMAKE_BINARY_DIR}/glad c --header-only --mx
    COMMENT "Generating the GL 4.5 core loader"
    VERBATIM)
add_custom_target(glad_header DEPENDS ${GLAD_HEADER})
add_library(glad INTERFACE)
add_dependencies(glad glad_header)
target_include_directories(glad SYSTEM INTERFACE ${GLAD_INCLUDE_DIR})
