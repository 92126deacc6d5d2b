# SPDX-License-Identifier: Apache-2.0
# tactus_wasm_module(OUTPUT SOURCES... EXPORTS FILE): a WebAssembly module of sources of the project, named by their paths from its top.
# FILE holds an option --export=NAME for each function that others call; malloc and free are added.
include_guard()

# The rules that a codec can report: those of recordings, scenes, devices and simulations are left out, with their texts. A source that
# names one of them does not compile.
file(READ ${PROJECT_BINARY_DIR}/include/tactus_rules.inc rows)
string(REGEX REPLACE "TACTUS_RULE\\(\"R-(CSV|DEV|FEM|KEY|LNK|NET|SCN|SEA|SEQ|SIM|TET|TGN|TRC)-[^\n]*\n" "" rows "${rows}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/wasm/include/tactus_rules.inc CONTENT "${rows}" @ONLY)

# Optimised as a whole, by the linker: smaller by 9 % and faster by a quarter. What runs once for a stream is built small (-Oz), what runs
# for a packet fast. The features (-m) are those of every browser since 2021 and of Node 18.
# Exceptions: the codec throws nothing but for lack of memory, which stops the module. So catch is ignored, and the headers do without.
function(tactus_wasm_flags source out)
  set(size -Os)
  if(source MATCHES "^codec/(base|scene|file)/|^codec/mesh/(cluster_basis|deformable_object|elastic_elements|graph|kriging)|^codec/(mesh_support|player|receiver)|^bindings/c/")
    set(size -Oz)
  endif()
  set(flags --target=wasm32-wasi -mbulk-memory -mnontrapping-fptoint -msign-ext -std=c++20 ${size} -flto -DNDEBUG
    -fexceptions -fignore-exceptions -U__EXCEPTIONS -U__cpp_exceptions -fno-rtti -ffp-contract=off -fvisibility=hidden
    -isystem ${WASM_CXX_INCLUDE} -I ${PROJECT_BINARY_DIR}/wasm/include -I ${PROJECT_BINARY_DIR}/include -I ${PROJECT_BINARY_DIR}/codec -I ${PROJECT_SOURCE_DIR}
    -I ${PROJECT_SOURCE_DIR}/bindings/c)
  if(TARGET tactus_thesis)
    list(APPEND flags -DTACTUS_HAS_THESIS)
  endif()
  find_package(tl-expected REQUIRED)
  get_target_property(include_dirs tl::expected INTERFACE_INCLUDE_DIRECTORIES)
  foreach(dir ${include_dirs})
    list(APPEND flags -idirafter ${dir})
  endforeach()
  set(${out} ${flags} PARENT_SCOPE)
endfunction()

# The object of a source is built once, for all modules.
function(tactus_wasm_object source out)
  string(REPLACE / - object ${source}.o)
  set(object ${PROJECT_BINARY_DIR}/wasm/${object})
  set(${out} ${object} PARENT_SCOPE)
  get_property(known GLOBAL PROPERTY TACTUS_WASM_OBJECTS)
  if(object IN_LIST known)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY TACTUS_WASM_OBJECTS ${object})
  tactus_wasm_flags(${source} flags)
  add_custom_command(OUTPUT ${object} DEPENDS ${PROJECT_SOURCE_DIR}/${source} DEPFILE ${object}.d
    COMMENT "Building WebAssembly object ${source}"
    COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} $<TARGET_FILE:WasmClang::compiler> ${flags} -MD -MF ${object}.d -MT ${object}
      -c ${PROJECT_SOURCE_DIR}/${source} -o ${object} VERBATIM)
endfunction()

function(tactus_wasm_module output)
  cmake_parse_arguments(PARSE_ARGV 1 module "" EXPORTS SOURCES)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/wasm)
  set(objects)
  foreach(source ${module_SOURCES})
    tactus_wasm_object(${source} object)
    list(APPEND objects ${object})
  endforeach()
  # Options of the linker go through a file: they are many. The stack comes first, so that to overflow it is a trap.
  # wasm-opt makes the module smaller by another 7 %.
  get_filename_component(name ${output} NAME)
  add_custom_command(OUTPUT ${output} DEPENDS ${module_EXPORTS} ${objects} COMMENT "Linking WebAssembly module ${name}"
    COMMAND WasmClang::compiler --target=wasm32-wasi -mexec-model=reactor -fuse-ld=lld -flto -L${WASM_CXX_LIBRARY}
      -Wl,--gc-sections,--strip-all,--stack-first,-z,stack-size=262144,--export=malloc,--export=free,@${module_EXPORTS}
      ${objects} -o ${name}.linked
    COMMAND WasmClang::optimizer -Os --enable-bulk-memory --enable-nontrapping-float-to-int --enable-sign-ext --enable-mutable-globals
      ${name}.linked -o ${output} VERBATIM)
endfunction()
