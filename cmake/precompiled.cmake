# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Headers of others that nearly every file includes, parsed once a target: they are most of a file's compile time. Files
# include what they use all the same; -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without.
function(shadow_layers_precompile target)
    target_precompile_headers(${target} PRIVATE
        <algorithm> <array> <atomic> <cmath> <cstdint> <functional> <glm/glm.hpp> <glm/gtc/matrix_transform.hpp> <limits>
        <map> <memory> <optional> <span> <string> <vector> ${ARGN})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        target_compile_options(${target} PRIVATE -fpch-preprocess)  # ccache asks for it
    endif()
endfunction()
