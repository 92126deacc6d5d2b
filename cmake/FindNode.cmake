# SPDX-License-Identifier: Apache-2.0
# Node::node and Node::npm
include(FindPackageHandleStandardArgs)

find_program(NODE_PROGRAM NAMES node nodejs)
find_program(NPM_PROGRAM npm)
mark_as_advanced(NODE_PROGRAM NPM_PROGRAM)
find_package_handle_standard_args(Node REQUIRED_VARS NODE_PROGRAM NPM_PROGRAM)

if(Node_FOUND AND NOT TARGET Node::node)
  add_executable(Node::node IMPORTED GLOBAL)
  set_target_properties(Node::node PROPERTIES IMPORTED_LOCATION ${NODE_PROGRAM})
  add_executable(Node::npm IMPORTED GLOBAL)
  set_target_properties(Node::npm PROPERTIES IMPORTED_LOCATION ${NPM_PROGRAM})
endif()
