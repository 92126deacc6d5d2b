# SPDX-License-Identifier: Apache-2.0
# WasmClang::compiler, a clang that builds C++20 for wasm32-wasi; WASM_CXX_INCLUDE and WASM_CXX_LIBRARY, the location of its standard library;
# WasmClang::optimizer, which makes modules smaller.
include(FindPackageHandleStandardArgs)

find_program(WASM_CLANG clang++-16)
find_program(WASM_LD wasm-ld-16)
find_program(WASM_OPT wasm-opt)
find_path(WASM_CXX_INCLUDE bit PATHS /usr/lib/llvm-16/include/wasm32-wasi/c++/v1 NO_DEFAULT_PATH)
find_path(WASM_CXX_LIBRARY libc++.a PATHS /usr/lib/llvm-16/lib/wasm32-wasi NO_DEFAULT_PATH)
find_path(WASM_LIBC libc.a PATHS /usr/lib/wasm32-wasi NO_DEFAULT_PATH)
mark_as_advanced(WASM_CLANG WASM_LD WASM_OPT WASM_CXX_INCLUDE WASM_CXX_LIBRARY WASM_LIBC)
find_package_handle_standard_args(WasmClang REQUIRED_VARS WASM_CLANG WASM_LD WASM_OPT WASM_CXX_INCLUDE WASM_CXX_LIBRARY WASM_LIBC)

if(WasmClang_FOUND AND NOT TARGET WasmClang::compiler)
  add_executable(WasmClang::compiler IMPORTED GLOBAL)
  set_target_properties(WasmClang::compiler PROPERTIES IMPORTED_LOCATION ${WASM_CLANG})
  add_executable(WasmClang::optimizer IMPORTED GLOBAL)
  set_target_properties(WasmClang::optimizer PROPERTIES IMPORTED_LOCATION ${WASM_OPT})
endif()
