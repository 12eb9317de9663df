# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
# Interface target with the warnings and the floating-point rules that every target of ours uses.
add_library(shadow_layers_options INTERFACE)
# No contraction: an edge function must give the same sign wherever it is compiled (algorithms of the exact kind).
target_compile_options(shadow_layers_options INTERFACE -Wall -Wextra -Wshadow -ffp-contract=off)
if(SHADOW_LAYERS_WERROR)
    target_compile_options(shadow_layers_options INTERFACE -Werror)
endif()
if(SHADOW_LAYERS_ASAN)
    target_compile_options(shadow_layers_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
    target_link_options(shadow_layers_options INTERFACE -fsanitize=address,undefined)
endif()
