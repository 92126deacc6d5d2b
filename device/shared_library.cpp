// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/shared_library.h>

#include <dlfcn.h>

namespace tactus::device {

tl::expected<SharedLibrary, std::string> SharedLibrary::load(const std::string& name) {
  if (void* const library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) return SharedLibrary(library);
  const char* const why = dlerror();
  return tl::unexpected(std::string(why != nullptr ? why : "it cannot be loaded"));
}

void* SharedLibrary::symbol(const char* name) noexcept {
  void* const found = dlsym(library_, name);
  if (found == nullptr && missing_ == nullptr) missing_ = name;
  return found;
}

}  // namespace tactus::device
